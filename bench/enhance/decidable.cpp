// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/decidable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/judgement/verdict.h"
#include "tod/psychometric/acuity.h"

namespace todbench {

std::string why_undecided(const std::string& name, const TodPoint& point) {
  if (!threshold_identified(point.fit)) return name + " has no threshold: " + std::string(to_string(point.fit.verdict));
  if (point.adequacy && !point.adequacy->adequate())
    return name + " is not fit for a decision: " + reasons_unfit(*point.adequacy);
  return "";
}

std::string why_undecided(const PackageResult& result, double set_delta_t_k) {
  const auto& points = result.curve.points;
  const auto point =
      std::ranges::find_if(points, [&](const TodPoint& p) { return same_contrast(p.set_delta_t_k, set_delta_t_k); });
  if (point == points.end()) return result.name + " has no answers at this contrast";
  return why_undecided(result.name, *point);
}

void withhold_undecided(std::vector<PairedRatio>& ratios, const PackageResult& with, const PackageResult& without) {
  for (PairedRatio& ratio : ratios) {
    for (const PackageResult* side : {&without, &with}) {
      if (ratio.withheld.empty()) ratio.withheld = why_undecided(*side, ratio.set_delta_t_k);
    }
    if (ratio.withheld.empty()) continue;
    ratio.ratio.reset();
    ratio.ci95 = {};
    ratio.spread.reset();
  }
}

int exit_code(const PackageResult& result) {
  const bool usable = std::ranges::all_of(
      result.curve.points, [&](const TodPoint& point) { return why_undecided(result, point.set_delta_t_k).empty(); });
  return usable && !result.curve.points.empty() ? 0 : 3;
}

std::optional<double> identified_acuity_per_mrad(const TodPoint& point) {
  return threshold_identified(point.fit) ? acuity_per_mrad(point.fit) : std::nullopt;
}

std::optional<JudgedPoint> judged_point(const PackageResult& result, double set_delta_t_k) {
  JudgedPoint sum;
  int set_ups = 0;
  for (const JudgedContrast& judged : result.judged) {
    if (!same_contrast(judged.set_delta_t_k, set_delta_t_k)) continue;
    sum.gain += judged.scale.gain;
    sum.gain_error = std::hypot(sum.gain_error, judged.scale.gain_error);
    sum.noise_k += judged.noise_k;
    ++set_ups;
  }
  if (set_ups == 0) return std::nullopt;
  return JudgedPoint{sum.gain / set_ups, sum.gain_error / set_ups, sum.noise_k / set_ups};
}

std::string why_not_linear(const PackageResult& result) {
  constexpr double least_difference = 0.05, least_certainty = 4;
  // Pictures of the previous contrast have other gains, too.
  const auto late = [](const AdequacyFinding& finding) { return finding.kind == FindingKind::picture_residue; };
  for (const TodPoint& point : result.curve.points) {
    if (point.adequacy && std::ranges::any_of(point.adequacy->findings, late)) return "";
  }
  for (const TodPoint& first : result.curve.points) {
    for (const TodPoint& second : result.curve.points) {
      const auto a = judged_point(result, first.set_delta_t_k), b = judged_point(result, second.set_delta_t_k);
      if (!a || !b) continue;
      const double difference = std::abs(a->gain - b->gain);
      if (!(difference > least_difference * std::abs(a->gain))) continue;
      if (!(difference > least_certainty * std::hypot(a->gain_error, b->gain_error))) continue;
      return fmt::format(
          "{}: its stages are not linear: they change the contrast by a factor of {:.3g} at {:g} K and {:.3g} at {:g} "
          "K. The observer judges in units of the contrast of the large triangles. Small triangles have another gain, "
          "which is part of the ratio",
          result.name, a->gain, first.set_delta_t_k, b->gain, second.set_delta_t_k);
    }
  }
  return "";
}

}  // namespace todbench
