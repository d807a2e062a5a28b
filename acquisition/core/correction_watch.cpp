// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/correction_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "acquisition/base/median.h"

namespace todbench {
namespace {

/// Lower limit of the usual difference, in counts. If the noise is finer than a count, rounding determines the
/// difference of two frames: 0.2 to 1.6 counts between successive frames of a Lepton at rest.
constexpr double least_difference = 1.5;

/// Every n-th pixel in both directions, about 5000 of them.
std::vector<std::uint16_t> sampled(const cv::Mat1w& counts) {
  constexpr double wanted = 5000;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(counts.total()) / wanted)));
  std::vector<std::uint16_t> out;
  out.reserve(counts.total() / static_cast<std::size_t>(step * step) + 1);
  for (int row = step / 2; row < counts.rows; row += step) {
    const std::uint16_t* pixels = counts.ptr<std::uint16_t>(row);
    for (int column = step / 2; column < counts.cols; column += step) out.push_back(pixels[column]);
  }
  return out;
}

template <typename T>
T quantile(std::vector<T>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

struct Difference {
  double level = 0;   ///< median
  double spread = 0;  ///< mean absolute deviation from it over the 95 % that deviate least
};

Difference difference(const std::vector<std::uint16_t>& now, const std::vector<std::uint16_t>& before) {
  std::vector<int> d(now.size());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = static_cast<int>(now[i]) - static_cast<int>(before[i]);
  const int level = quantile(d, 0.5);
  for (int& value : d) value = std::abs(value - level);
  (void)quantile(d, 0.95);
  const auto kept = std::max<std::size_t>(1, static_cast<std::size_t>(0.95 * static_cast<double>(d.size())));
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) sum += d[i];
  return {.level = static_cast<double>(level), .spread = sum / static_cast<double>(kept)};
}

double range_of(std::vector<std::uint16_t> pixels) {
  const double low = quantile(pixels, 0.01);
  return quantile(pixels, 0.99) - low;
}

}  // namespace

std::string_view to_string(CorrectionSign sign) {
  switch (sign) {
    case CorrectionSign::frozen_picture:
      return "frozen picture";
    case CorrectionSign::shutter:
      return "shutter";
    case CorrectionSign::level_jump:
      return "level jump";
    case CorrectionSign::pattern_change:
      return "pattern change";
  }
  return "unknown";
}

std::optional<CorrectionSign> CorrectionWatch::see(const Frame& frame) {
  equal_frames_ = 1;
  std::vector<std::uint16_t> now = sampled(frame.counts);
  if (now.empty()) return std::nullopt;
  const double range = range_of(now);
  const std::vector<std::uint16_t> before = std::exchange(previous_, std::move(now));
  if (before.size() != previous_.size()) {
    usual_range_ = std::max(range, usual_range_.value_or(0));
    return std::nullopt;
  }
  const Difference seen = difference(previous_, before);
  const bool ready = static_cast<int>(differences_.size()) >= options_.history;
  const double usual = ready ? std::max(median({differences_.begin(), differences_.end()}), least_difference) : 0;
  const double usual_range = usual_range_.value_or(range);
  remember(seen.spread, range);
  if (!ready) return std::nullopt;
  if (range < options_.shutter_range_ratio * usual_range) return CorrectionSign::shutter;
  if (seen.spread > options_.pattern_ratio * usual) return CorrectionSign::pattern_change;
  if (std::abs(seen.level) > options_.level_jump * usual) return CorrectionSign::level_jump;
  return std::nullopt;
}

void CorrectionWatch::remember(double spread, double range) {
  differences_.push_back(spread);
  if (static_cast<int>(differences_.size()) > options_.history) differences_.pop_front();
  usual_range_ = std::max(range, usual_range_.value_or(0));
}

std::optional<CorrectionSign> CorrectionWatch::see_frozen() {
  ++equal_frames_;
  if (equal_frames_ < options_.frozen_frames) return std::nullopt;
  return CorrectionSign::frozen_picture;
}

void CorrectionWatch::scene_changed() {
  previous_.clear();
  usual_range_.reset();
  equal_frames_ = 1;
}

}  // namespace todbench
