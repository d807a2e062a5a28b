// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences about a design of least bench time.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/forecast/design_search.h"
#include "bench/forecast/ramp_advice.h"
#include "bench/plan/plan_options.h"
#include "bench/report/number_format.h"
#include "bench/text/text.h"
#include "tod/psychometric/clustered_variance.h"
#include "tod/schedule/even_phases.h"

namespace todbench {
namespace {

std::string in_words(const RampDesign& ramp, const PricedDesign& best) {
  const SchedulePlan& schedule = ramp.design.plan.schedule;
  std::vector<std::string> half_widths;
  for (const ContrastPrediction& contrast : ramp.design.contrasts)
    half_widths.push_back(contrast.uncertainty_percent ? significant(*contrast.uncertainty_percent, 2) : "no");
  std::string text = fmt::format(
      "a ramp from {:g} to {:g} K at {:.3g} K/s ({} contrast lag of {:g} s allows up to {:.3g} K/s) takes {:.0f} s "
      "with half-widths of {} %",
      *schedule.from_delta_t_k, *schedule.to_delta_t_k, *schedule.ramp_k_per_s,
      ramp.lag_is_stated ? "the stated" : "an assumed", ramp.lag_s,
      largest_ramp_rate(*schedule.from_delta_t_k, ramp.lag_s), ramp.design.bench_s, fmt::join(half_widths, ", "));
  if (ramp.design.plan == best.plan) return text + ": it is the fastest design";
  if (!ramp.meets) return text + ", which are not enough";
  if (ramp.design.bench_s >= least_design_gain * best.bench_s) return text + ": it is no faster";
  return text + ": it is faster. Measure the lag of the plate and state max_contrast_lag_s to use it";
}

}  // namespace

std::string times_in_words(const BestDesign& found) {
  const auto of = [](const PricedDesign& design) {
    return fmt::format("{:.0f} s of bench time", design.bench_s) +
           (design.half_width_percent ? fmt::format(" with half-widths of at most {:.3g} %", *design.half_width_percent)
                                      : "");
  };
  return "the design takes " + of(found.best) + ", the plan as it was " + of(found.as_planned);
}

std::vector<std::string> in_words(const BestDesign& found) {
  const PricedDesign& best = found.best;
  const ScheduleKind kind = best.plan.schedule.kind;
  std::vector<std::string> out;
  out.push_back(
      fmt::format("{}. Changes of the target take {:.0f} s of the design", times_in_words(found), best.changes_s));
  if (kind == ScheduleKind::constant)
    out.back() += fmt::format(
        "; no constant design of this bench with {} set-ups or more is faster than {:.0f} s, whatever its half-width",
        std::min(found.set_ups, static_cast<int>(least_set_ups)), found.least_s);
  if (found.planned_meets && found.as_planned.bench_s < best.bench_s)
    out.push_back(
        fmt::format("the plan as it was is faster, with fewer than {} phases or {} presentations per contrast",
                    least_design_phases, least_graded_presentations));
  if (kind == ScheduleKind::adaptive)
    out.push_back(fmt::format(
        "the adaptive schedule of the plan to half_width_percent = {:g} is the fastest: {} set-ups are "
        "expected{}",
        best.plan.schedule.half_width_percent, found.set_ups,
        found.not_adaptive_s ? fmt::format(", and the best other design takes {:.0f} s", *found.not_adaptive_s) : ""));
  else
    out.push_back(
        found.unpaired_share > 0
            ? fmt::format("{} set-ups. {:.0f} % of them have no counterpart rotated by 180 degrees: an error "
                          "that changes its sign with this rotation enters S75 with {:.0f} % of its size, and "
                          "its scatter is in the interval",
                          found.set_ups, 100 * found.unpaired_share, 100 * found.unpaired_share)
            : fmt::format("{} set-ups, each with its counterpart rotated by 180 degrees: an error that changes "
                          "its sign with this rotation cancels",
                          found.set_ups));
  const int phases = best.plan.target.phases;
  if (kind == ScheduleKind::constant)
    out.push_back(
        fmt::format("{} phases in each set-up cancel every harmonic of the pixel grid below {:.1f} per pixel; "
                    "what is left has a new start in each set-up, and its scatter is in the interval",
                    phases, least_harmonic(phases)));
  if (found.settled_s && kind == ScheduleKind::constant)
    out.push_back(
        fmt::format("presentations begin within {:g} % of the set contrast, and their own frames give their "
                    "contrasts; if every contrast settles, the best design takes {:.0f} s",
                    best.plan.target.contrast_settling_band_percent, *found.settled_s));
  const int frames = best.plan.measurement.contrast_frames, planned = found.as_planned.plan.measurement.contrast_frames;
  if (frames != planned)
    out.push_back(
        fmt::format("each contrast is measured with {} frames ([measurement] contrast_frames) in place of {}: "
                    "its scatter enters S75, and no presentation reduces it",
                    frames, planned));
  if (found.ramp) out.push_back(in_words(*found.ramp, best));
  const bool by_presentations =
      kind != ScheduleKind::adaptive && std::ranges::any_of(best.contrasts, [&](const ContrastPrediction& contrast) {
        return contrast.degrees_of_freedom && !contrast.over_set_ups;
      });
  if (by_presentations)
    out.emplace_back(
        "the set-ups have unequal shares of the information and count as fewer than five: the intervals come from "
        "presentations and places. They are safe, and longer than those of set-ups");
  if (found.equivalence_half_width_percent)
    out.push_back(fmt::format("to compare camera and twin within {:g} %, every half-width is at most {} %",
                              *best.plan.limits.equivalence_margin_percent,
                              significant(*found.equivalence_half_width_percent, 2)));
  for (const double delta_t_k : found.dropped_contrasts_k)
    out.push_back("the contrast of " + number_text(delta_t_k) + " K is left out, because no limit names it");
  return out;
}

}  // namespace todbench
