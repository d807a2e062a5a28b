// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/run_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bench/text/text.h"

namespace todbench {
namespace {

/// Reason why presentations cannot have a contrast of their own; empty: they can.
std::string lacks_own_contrasts(const Plan& plan) {
  if (plan.target.kind != TargetKind::scpi && plan.target.kind != TargetKind::scene)
    return "needs [target] kind \"scpi\" or \"scene\": the target has to change its contrast by itself";
  if (plan.camera.contrast == ContrastUnit::grey_levels)
    return "needs contrasts in kelvin, and [camera] contrast is \"grey-levels\"";
  if (plan.fit.estimator == EstimatorChoice::weibull || plan.schedule.answers == AnswersChoice::binary ||
      plan.fit.lapse != 0.0 || !plan.modules.empty())
    return "needs graded answers that are fitted with the function of the twin: no estimator \"weibull\", no answers "
           "\"binary\", no lapse, no [[module]]";
  return "";
}

bool is_ramp(const Plan& plan) {
  return plan.schedule.kind == ScheduleKind::ramp;
}

ValueMistakes needed_for_ramp(const Plan& plan, const std::optional<double>& value, std::string_view what) {
  if (!is_ramp(plan) || value) return {};
  return {{std::nullopt, "needed for [schedule] kind \"ramp\", expected " + std::string(what)}};
}

}  // namespace

ValueMistakes check_schedule_kind(const Plan& plan, std::size_t /*row*/) {
  if (!is_ramp(plan)) return {};
  if (const std::string lacks = lacks_own_contrasts(plan); !lacks.empty()) return {{std::nullopt, "a ramp " + lacks}};
  constexpr std::size_t least = 5;
  const std::size_t set_ups = set_ups_of(plan.target);
  if (set_ups >= least) return {};
  return {{std::nullopt, "a ramp needs at least five set-ups (plates in their mountings), found " +
                             std::to_string(set_ups) + ": its interval comes from the scatter over them"}};
}

ValueMistakes check_ramp_rate(const Plan& plan, std::size_t /*row*/) {
  const auto& rate = plan.schedule.ramp_k_per_s;
  if (!is_ramp(plan) || (rate && *rate > 0)) return needed_for_ramp(plan, rate, "a rate above 0 K/s");
  if (!rate) return needed_for_ramp(plan, rate, "a rate above 0 K/s");
  if (*rate == 0) return {{std::nullopt, "a rate of 0 K/s never leaves from_delta_t_k, expected a rate above 0 K/s"}};
  return {{std::nullopt, "a rate of " + number_text(*rate) +
                             " K/s has the wrong sign, expected one above 0 K/s: a ramp always falls from "
                             "from_delta_t_k to to_delta_t_k and rises again"}};
}

ValueMistakes check_ramp_from(const Plan& plan, std::size_t /*row*/) {
  return needed_for_ramp(plan, plan.schedule.from_delta_t_k, "the contrast at which a ramp begins");
}

ValueMistakes check_ramp_to(const Plan& plan, std::size_t /*row*/) {
  if (!is_ramp(plan) || !plan.schedule.to_delta_t_k || !plan.schedule.from_delta_t_k)
    return needed_for_ramp(plan, plan.schedule.to_delta_t_k, "the contrast at which a ramp turns");
  const double from = *plan.schedule.from_delta_t_k, to = *plan.schedule.to_delta_t_k;
  const std::string ramp = number_text(from) + " K to " + number_text(to) + " K";
  if (!(from * to > 0) || !(std::abs(from) > std::abs(to)))
    return {{std::nullopt, "a ramp falls towards 0 without reaching it, but the plan states " + ramp}};
  for (const double delta_t_k : plan.target.delta_t_k) {
    constexpr double rounding = 1e-6;
    const double share = delta_t_k / to;
    if (share >= 1 - rounding && share <= from / to * (1 + rounding)) continue;
    return {{std::nullopt,
             "the contrast " + number_text(delta_t_k) + " K of [target] delta_t_k is outside the ramp, " + ramp}};
  }
  return {};
}

ValueMistakes check_contrast_lag(const Plan& plan, std::size_t /*row*/) {
  return needed_for_ramp(plan, plan.target.max_contrast_lag_s,
                         "the longest lag between small and large triangles of the plate; measure it, it limits the "
                         "rate (method/measurement.md)");
}

ValueMistakes check_settling_band(const Plan& plan, std::size_t /*row*/) {
  if (!(plan.target.contrast_settling_band_percent > 0)) return {};
  std::string lacks = lacks_own_contrasts(plan);
  if (lacks.empty() && plan.schedule.kind == ScheduleKind::adaptive)
    lacks = "needs [schedule] kind \"constant\" or \"ramp\"";
  if (lacks.empty()) return {};
  return {{std::nullopt, "a contrast of each presentation " + lacks}};
}

ValueMistakes check_force(const Plan& plan, std::size_t /*row*/) {
  ValueMistakes mistakes;
  for (std::size_t i = 0; i < plan.simulation.force.size(); ++i) {
    for (const auto skipped : plan.simulation.skip) {
      if (skipped != plan.simulation.force[i]) continue;
      mistakes.push_back({i, "'" + std::string(to_string(skipped)) + "' is also in skip"});
    }
  }
  return mistakes;
}

ValueMistakes check_frames_per_presentation(const Plan& plan, std::size_t /*row*/) {
  const std::vector<int>& frames = plan.schedule.frames_per_presentation;
  if (frames.size() > 1 && frames.size() != plan.target.delta_t_k.size()) {
    return {{std::nullopt, "expected one number, or one for each of the " +
                               std::to_string(plan.target.delta_t_k.size()) + " contrasts of delta_t_k, found " +
                               std::to_string(frames.size())}};
  }
  if (plan.schedule.answers != AnswersChoice::binary || std::ranges::all_of(frames, [](int n) { return n <= 1; }))
    return {};
  return {{std::nullopt, "more than one frame needs answers = \"graded\": a binary answer is made from one frame"}};
}

ValueMistakes check_estimator(const Plan& plan, std::size_t /*row*/) {
  if (plan.schedule.answers != AnswersChoice::graded) return {};
  if (plan.fit.estimator == EstimatorChoice::weibull) {
    return {{std::nullopt,
             "answers = \"graded\" needs \"twin-shape\": the error of a Weibull function is larger than the interval "
             "of graded answers"}};
  }
  if (plan.fit.lapse == 0.0) return {};
  return {{std::nullopt, "graded answers need lapse = 0, because their observer does not lapse"}};
}

}  // namespace todbench
