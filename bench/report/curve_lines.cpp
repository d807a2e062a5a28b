// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/curve_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

/// Acuity at a contrast; empty without a threshold.
struct AcuityNow {
  std::optional<double> acuity;
  Interval interval;
};

AcuityNow acuity_at(const TodCurve* curve, double delta_t_k) {
  const TodPoint* point = curve == nullptr ? nullptr : point_at(*curve, delta_t_k);
  if (point == nullptr) return {};
  return {stated_acuity_per_mrad(point->fit), acuity_interval(point->fit.ci95)};
}

std::string acuity_text(const AcuityNow& now) {
  const auto number = [](const std::optional<double>& value) -> std::string {
    if (!value || !std::isfinite(*value)) return "–";
    // Ends of intervals may be orders of magnitude away.
    return *value < 100 ? fmt::format("{:.3f}", *value) : fmt::format("{:.3g}", *value);
  };
  if (!now.acuity) return "–";
  return fmt::format("{} [{}, {}]", number(now.acuity), number(now.interval.low), number(now.interval.high));
}

/// Characters of a line of the plot, one UTF-8 character each.
class TextLine {
 public:
  TextLine(std::size_t width, double largest) : cells_(width, " "), largest_(largest) {}
  void put(double value, const char* sign) {
    if (const auto place = place_of(value)) cells_[*place] = sign;
  }
  void bar(const Interval& interval) {
    if ((!interval.low && !interval.high) || interval.low.value_or(0) > largest_) return;
    const std::size_t from = place_of(interval.low.value_or(0)).value_or(0);
    const std::size_t to = place_of(interval.high.value_or(largest_)).value_or(cells_.size() - 1);
    for (std::size_t i = from; i <= to; ++i) cells_[i] = "─";
    if (interval.low) cells_[from] = "├";
    if (interval.high && *interval.high <= largest_) cells_[to] = "┤";
  }
  [[nodiscard]] std::string text() const {
    std::string out;
    for (const std::string& cell : cells_) out += cell;
    return out;
  }

 private:
  [[nodiscard]] std::optional<std::size_t> place_of(double value) const {
    if (!std::isfinite(value) || value < 0 || value > largest_) return std::nullopt;
    return static_cast<std::size_t>(std::lround(value / largest_ * static_cast<double>(cells_.size() - 1)));
  }

  std::vector<std::string> cells_;
  double largest_;
};

/// Returns the end of the axis: a round number beyond all drawn values. Intervals are cut at twice the largest acuity
/// or limit.
double axis_end(const CurveLines& shown) {
  double largest = 0, reach = 0;
  for (const AcuityLimit& limit : shown.limits) largest = std::max(largest, limit.least_acuity_per_mrad);
  for (const double contrast : shown.delta_t_k) {
    for (const TodCurve* curve : {shown.measured, shown.twin}) {
      const AcuityNow now = acuity_at(curve, contrast);
      if (now.acuity && std::isfinite(*now.acuity)) largest = std::max(largest, *now.acuity);
      if (now.acuity && now.interval.high && std::isfinite(*now.interval.high))
        reach = std::max(reach, *now.interval.high);
    }
  }
  const double end = std::max(largest, std::min(reach, 2 * largest));
  if (!(end > 0)) return 1;
  const double step = std::pow(10, std::floor(std::log10(end))) / 2;
  return std::ceil(end / step * (1 - 1e-12)) * step;
}

}  // namespace

std::vector<std::string> curve_lines(const CurveLines& shown, std::size_t columns) {
  constexpr std::size_t least_columns = 40, most_columns = 110, beside = 36;
  columns = std::clamp(columns, least_columns, most_columns);
  const bool numbers = columns > beside + least_columns / 2;
  const std::size_t width = columns - (numbers ? beside : 12);
  const double end = axis_end(shown);
  constexpr std::size_t wide = 50;
  const std::string heading =
      fmt::format("0 … {:.3g} 1/mrad", end) + (width >= wide ? "   ● measured  ○ twin  ┆ limit" : "");
  std::vector<std::string> lines{fmt::format("{:>9} |{:<{}}|", "dT [K]", heading, width)};
  for (const double contrast : shown.delta_t_k) {
    TextLine line(width, end);
    const AcuityNow measured = acuity_at(shown.measured, contrast), twin = acuity_at(shown.twin, contrast);
    for (const AcuityLimit& limit : shown.limits) {
      if (same_contrast(limit.delta_t_k, contrast)) line.put(limit.least_acuity_per_mrad, "┆");
    }
    if (measured.acuity) line.bar(measured.interval);
    if (twin.acuity) line.put(*twin.acuity, "○");
    if (measured.acuity) line.put(*measured.acuity, "●");
    lines.push_back(fmt::format("{:>9} |{}|", number_text(contrast), line.text()));
    if (numbers) lines.back() += " " + acuity_text(measured.acuity ? measured : twin);
  }
  return lines;
}

std::string curve_in_one_line(const CurveLines& shown) {
  std::string out;
  for (const double contrast : shown.delta_t_k) {
    out += (out.empty() ? "" : ", ") + number_text(contrast) + " K " + acuity_text(acuity_at(shown.measured, contrast));
  }
  return "acuity [1/mrad] so far: " + out;
}

}  // namespace todbench
