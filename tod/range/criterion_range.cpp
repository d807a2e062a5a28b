// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/criterion_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

/// Geometric bisection between a range whose ratio is above `wanted` and one whose ratio is at most that or unknown.
double bisected(const std::function<std::optional<double>(double)>& ratio, double wanted, double inside,
                double outside) {
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(inside) * std::sqrt(outside);
    if (!(middle > inside && middle < outside)) break;
    const auto x = ratio(middle);
    (x && *x > wanted ? inside : outside) = middle;
  }
  return std::sqrt(inside) * std::sqrt(outside);
}

}  // namespace

ResolvedPerMrad resolved_cycles(LogLinearCurve curve) {
  return [curve = std::move(curve)](double contrast) { return curve.highest_frequency_at(contrast); };
}

ResolvedPerMrad resolved_cycles(LogLinearCurve horizontal, LogLinearCurve vertical) {
  return [h = std::move(horizontal), v = std::move(vertical)](double contrast) -> std::optional<double> {
    const auto f_h = h.highest_frequency_at(contrast), f_v = v.highest_frequency_at(contrast);
    if (!f_h || !f_v) return std::nullopt;
    return std::sqrt(*f_h * *f_v);
  };
}

ResolvedPerMrad resolved_values(LogLinearCurve ctf) {
  return
      [ctf = std::move(ctf)](double contrast) -> std::optional<double> { return ctf.root_excess_integral(contrast); };
}

std::string_view to_string(DominantLimit limit) {
  return limit == DominantLimit::contrast ? "contrast" : "resolution";
}

std::optional<RangeSensitivity> sensitivity_of(
    const std::function<std::optional<double>(double size_factor, double contrast_factor)>& range) {
  constexpr double step = 0.01;
  // Decreases only: no range beyond the end of a table is needed, nor a contrast above the highest of a curve.
  const auto here = range(1, 1), smaller = range(std::exp(-step), 1), fainter = range(1, std::exp(-step));
  if (!here || !smaller || !fainter) return std::nullopt;
  return RangeSensitivity{std::log(*here / *smaller) / step, std::log(*here / *fainter) / step};
}

std::optional<double> criterion_ratio(const ResolvedPerMrad& resolved, const CriterionTarget& target,
                                      const Transmittance& air, const Criterion& criterion, double range_m) {
  const auto transmittance = air.at(range_m);
  if (!transmittance) return std::nullopt;
  const auto per_mrad = resolved(target.contrast * *transmittance);
  if (!per_mrad) return std::nullopt;
  return 1000 * target.size_m / range_m * *per_mrad / criterion.at_half;
}

namespace {

CriterionRange found_range(const ResolvedPerMrad& resolved, const CriterionTarget& target, const Transmittance& air,
                           const Criterion& criterion, double wanted) {
  const auto ratio = [&](double range_m) { return criterion_ratio(resolved, target, air, criterion, range_m); };
  CriterionRange found;
  const auto best = resolved(target.contrast);
  if (!best || *best <= 0) {
    found.reason =
        fmt::format("the target's contrast of {:g} lies below the lowest contrast of the curve", target.contrast);
    return found;
  }
  // The range without air; air can only shorten it.
  const double farthest = 1000 * target.size_m * *best / (criterion.at_half * wanted);
  const double end = std::min(farthest, air.end_m());
  if (const auto at_end = ratio(end); at_end && *at_end > wanted * (1 + 1e-12)) {
    found.at_least_m = end;
    found.reason = fmt::format(
        "the criterion is still exceeded at {0:g} m, the end of the table of transmittances: the range is at least "
        "{0:g} m",
        end);
    return found;
  }
  double inside = end;
  for (int i = 0; i < 1100; ++i) {
    inside /= 2;
    if (const auto x = ratio(inside); x && *x > wanted) break;
  }
  const double crossing = bisected(ratio, wanted, inside, end * (1 + 1e-12));
  // The curve ends before the criterion is met: it is not known below its lowest point.
  if (const auto before = ratio(crossing * (1 - 1e-9)); !before || *before > wanted * (1 + 1e-6)) {
    if (crossing < nearest_range_m) {
      found.reason = fmt::format(
          "the target has the lowest contrast of the curve, {:g}, and the air reduces it below this contrast at every "
          "distance",
          target.contrast);
      return found;
    }
    found.at_least_m = crossing;
    found.reason = fmt::format(
        "the criterion is still exceeded at {0:.4g} m, beyond which the apparent contrast lies below the lowest "
        "contrast of the curve: the range is at least {0:.4g} m",
        crossing);
    return found;
  }
  found.range_m = crossing;
  return found;
}

}  // namespace

CriterionRange range_for_probability(const ResolvedPerMrad& resolved, const CriterionTarget& target,
                                     const Transmittance& air, const Criterion& criterion, double probability) {
  const double wanted = ratio_for_probability(criterion.form, probability);
  CriterionRange found = found_range(resolved, target, air, criterion, wanted);
  if (!found.range_m) return found;
  found.sensitivity = sensitivity_of([&](double size_factor, double contrast_factor) {
    const CriterionTarget changed{target.size_m * size_factor, target.contrast * contrast_factor};
    return found_range(resolved, changed, air, criterion, wanted).range_m;
  });
  return found;
}

}  // namespace todbench
