// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/ramp_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/precision_frontier.h"
#include "bench/forecast/prediction.h"
#include "bench/plan/plan_options.h"
#include "bench/report/number_format.h"

namespace todbench {
namespace {

constexpr double allowed_change = 0.006;  ///< of the contrast, by the lag

Result<ContrastWay> way_of(const Plan& asked, const ExperimentInputs& inputs) {
  const Plan plan = as_measured(with_frames(asked, inputs));
  TODBENCH_TRY(const auto prediction, predict_plan(plan, inputs));
  return ContrastWay{bench_time(plan, inputs.plates, inputs.sensor.frame_rate_hz, {}).total_s(),
                     prediction.figures.predicted_uncertainty_percent};
}

/// "703 s (half-width of at most 1.3 %)".
std::string text_of(const ContrastWay& way) {
  return fmt::format("{:.0f} s", way.bench_s) +
         (way.half_width_percent ? fmt::format(" (half-width of at most {} %)", significant(*way.half_width_percent, 2))
                                 : "");
}

}  // namespace

double largest_ramp_rate(double from_k, double lag_s) {
  return lag_s > 0 ? allowed_change / lag_s * std::abs(from_k) : std::numeric_limits<double>::infinity();
}

Result<std::optional<RampComparison>> compare_ramp(const Plan& plan, const ExperimentInputs& inputs) {
  if (plan.schedule.kind != ScheduleKind::ramp) return std::nullopt;
  RampComparison out{.lag_s = plan.target.max_contrast_lag_s.value_or(0),
                     .rate_k_per_s = plan.schedule.ramp_k_per_s.value_or(0)};
  out.largest_rate_k_per_s = largest_ramp_rate(plan.schedule.from_delta_t_k.value_or(0), out.lag_s);
  TODBENCH_TRY(out.ramp, way_of(plan, inputs));
  if (std::isfinite(out.largest_rate_k_per_s)) {
    Plan other = plan;
    other.schedule.ramp_k_per_s = out.largest_rate_k_per_s;
    TODBENCH_TRY(out.at_largest, way_of(other, inputs));
  }
  Plan settled = with_settled_contrasts(plan);
  settled.schedule.frames_per_presentation = {0};  // those of a ramp fill its steps
  TODBENCH_TRY(out.settled, way_of(settled, inputs));
  settled.target.contrast_settling_band_percent = studied_band_percent;
  TODBENCH_TRY(out.within_band, way_of(settled, inputs));
  return out;
}

std::string ramp_advice(const Plan& plan, const ExperimentInputs& inputs) {
  const auto compared = compare_ramp(plan, inputs);
  if (!compared || !*compared) return "";
  const RampComparison& ways = **compared;
  constexpr double alike = 1.05;
  const auto as_fast = [](const ContrastWay& way, double ramp_s) {
    return way.bench_s > 0 && way.bench_s <= alike * ramp_s;
  };
  const bool too_fast = ways.rate_k_per_s > ways.largest_rate_k_per_s;
  const double planned_s = too_fast ? ways.at_largest->bench_s : ways.ramp.bench_s;
  const bool slow = as_fast(ways.settled, planned_s) || as_fast(ways.within_band, planned_s);
  if (!too_fast && !slow) return "";
  const bool timed = ways.ramp.bench_s > 0;
  std::string text =
      too_fast ? fmt::format(
                     "a contrast lag of {:g} s at {:g} K/s changes the contrast between large and small "
                     "triangles by {} %; up to {:.3g} K/s it stays below {:.1f} %",
                     ways.lag_s, ways.rate_k_per_s,
                     significant(100 * allowed_change * ways.rate_k_per_s / ways.largest_rate_k_per_s, 2),
                     ways.largest_rate_k_per_s, 100 * allowed_change)
               : fmt::format("the ramp at {:g} K/s takes {} on the bench", ways.rate_k_per_s, text_of(ways.ramp));
  if (too_fast && timed) text += ", and the ramp takes " + text_of(*ways.at_largest) + " on the bench";
  constexpr double another_rate = 1.01;
  if (!too_fast && ways.largest_rate_k_per_s > another_rate * ways.rate_k_per_s && ways.at_largest)
    text += fmt::format("; a contrast lag of {:g} s allows up to {:.3g} K/s, which takes {}", ways.lag_s,
                        ways.largest_rate_k_per_s, text_of(*ways.at_largest));
  if (!slow) return text;
  const double best_s = ways.at_largest ? std::min(planned_s, ways.at_largest->bench_s) : planned_s;
  const bool settled = as_fast(ways.settled, best_s), band = as_fast(ways.within_band, best_s);
  text += fmt::format(
      ". With the phases of the plan, settled contrasts (schedule kind \"constant\") take {}, contrasts within a band "
      "(contrast_settling_band_percent = {:g}) {}",
      text_of(ways.settled), studied_band_percent, text_of(ways.within_band));
  if (!settled && !band) return text + ": the largest rate is the fastest way";
  text += settled && band ? ": take one of these, which are"
          : settled       ? ": take settled contrasts, which are"
                          : ": take the band, which is";
  return text + " as fast as the ramp or faster; more phases narrow the half-width";
}

}  // namespace todbench
