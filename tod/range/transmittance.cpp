// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/transmittance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr double floor_of_tables = 1e-8;

Result<void> check(const TransmittancePoint& row, const TransmittancePoint* before) {
  if (!std::isfinite(row.range_m) || row.range_m < 0)
    return fail(ErrorCode::invalid_input, fmt::format("a range must be 0 m or more, found {:g} m", row.range_m));
  if (!(row.transmittance >= 0 && row.transmittance <= 1)) {
    return fail(ErrorCode::invalid_input, fmt::format("the transmittance at {:g} m must be from 0 to 1, found {:g}",
                                                      row.range_m, row.transmittance));
  }
  if (row.range_m == 0 && row.transmittance != 1) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the transmittance at 0 m must be 1, found {:g}", row.transmittance));
  }
  if (before == nullptr) return {};
  if (!(row.range_m > before->range_m)) {
    return fail(ErrorCode::invalid_input,
                fmt::format("ranges must increase, found {:g} m after {:g} m", row.range_m, before->range_m));
  }
  if (row.transmittance > before->transmittance) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the transmittance must not increase with range, found {:g} at {:g} m after {:g} at {:g} m",
                            row.transmittance, row.range_m, before->transmittance, before->range_m));
  }
  return {};
}

}  // namespace

Transmittance Transmittance::beer_lambert(double extinction_per_km) {
  return of_spectrum({1}, {extinction_per_km});
}

Result<Transmittance> Transmittance::of_table(std::span<const TransmittancePoint> rows) {
  if (rows.empty()) return fail(ErrorCode::invalid_input, "the table of transmittances is empty");
  Transmittance air;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TODBENCH_TRY_VOID(check(rows[i], i > 0 ? &rows[i - 1] : nullptr));
    if (rows[i].range_m == 0 || rows[i].transmittance < floor_of_tables) continue;
    // -log(1) is -0: the depth of clear air is 0.
    air.rows_.push_back({rows[i].range_m, std::abs(std::log(rows[i].transmittance))});
  }
  if (air.rows_.size() < 2) {
    return fail(
        ErrorCode::invalid_input,
        "the table of transmittances needs at least two ranges above 0 m with a transmittance of at least 1e-8");
  }
  return air;
}

Transmittance Transmittance::of_spectrum(std::vector<double> weights, std::vector<double> extinction_per_km) {
  assert(!weights.empty() && weights.size() == extinction_per_km.size());
  Transmittance air;
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  air.weights_ = std::move(weights);
  air.extinction_per_km_ = std::move(extinction_per_km);
  return air;
}

double Transmittance::table_depth(double range_m) const {
  if (range_m <= 0) return 0;
  auto above = std::lower_bound(rows_.begin(), rows_.end(), range_m,
                                [](const Row& row, double range) { return row.range_m < range; });
  if (above == rows_.end()) above = std::prev(rows_.end());
  const bool before_first = above == rows_.begin();
  const Row& a = before_first ? rows_[0] : *std::prev(above);
  const Row& b = before_first ? rows_[1] : *above;
  if (a.depth == 0) return before_first ? 0 : b.depth * (range_m - a.range_m) / (b.range_m - a.range_m);
  double power = std::log(b.depth / a.depth) / std::log(b.range_m / a.range_m);
  // A table that is constant over its first rows does not determine the air before them: one coefficient.
  if (before_first && power <= 0) power = 1;
  return a.depth * std::pow(range_m / a.range_m, power);
}

std::optional<double> Transmittance::optical_depth(double range_m) const {
  if (range_m > end_m()) return std::nullopt;
  if (!rows_.empty()) return factor_ * table_depth(range_m);
  const double range_km = range_m / 1000;
  // Relative to the clearest wavelength, so that a long path does not underflow to 0.
  double clearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (weights_[i] > 0) clearest = std::min(clearest, extinction_per_km_[i]);
  }
  if (weights_.size() == 1) return factor_ * extinction_per_km_[0] * range_km;
  double sum = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i)
    sum += weights_[i] * std::exp(-(extinction_per_km_[i] - clearest) * range_km);
  return std::max(0.0, factor_ * (clearest * range_km - std::log(sum)));
}

std::optional<double> Transmittance::at(double range_m) const {
  const auto depth = optical_depth(range_m);
  if (!depth) return std::nullopt;
  return std::exp(-*depth);
}

double Transmittance::end_m() const {
  return rows_.empty() ? std::numeric_limits<double>::infinity() : rows_.back().range_m;
}

Transmittance Transmittance::with_depth_times(double factor) const {
  Transmittance scaled = *this;
  scaled.factor_ *= factor;
  return scaled;
}

}  // namespace todbench
