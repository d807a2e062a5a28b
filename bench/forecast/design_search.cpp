// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/design_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/contrast_forecast.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/forecast/limit_forecast.h"
#include "bench/forecast/mounting_choices.h"
#include "bench/forecast/ramp_advice.h"
#include "bench/plan/plan_options.h"
#include "bench/plan/run_checks.h"
#include "bench/report/number_format.h"
#include "tod/presentation/largest_contrast.h"
#include "tod/psychometric/clustered_variance.h"

namespace todbench {
namespace {

constexpr std::array phase_choices{
    least_design_phases, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 20, 24, 32, 48, 64, 96, 128};
constexpr int most_frames = 256;
constexpr double decided = 0.95, coarsest_percent = 10;

/// Largest half-width at any contrast of a design that decides, in percent.
double most_percent(const LimitsPlan& limits) {
  return limits.equivalence_margin_percent ? std::min(coarsest_percent, *limits.equivalence_margin_percent / 3)
                                           : coarsest_percent;
}

/// Requirement at each contrast.
class Criterion {
 public:
  Criterion(const Plan& plan, const DesignRequest& request, double half_width_percent, const CurveUncertainty* budget)
      : plan_(plan), decide_(request.decide), half_width_percent_(half_width_percent), budget_(budget) {}

  [[nodiscard]] bool met(const PricedDesign& design) const {
    return std::ranges::all_of(design.contrasts, [&](const ContrastPrediction& contrast) { return met(contrast); });
  }
  [[nodiscard]] bool met(const ContrastPrediction& contrast) const {
    if (!contrast.uncertainty_percent || !contrast.s75_mrad) return false;
    if (*contrast.uncertainty_percent > (decide_ ? most_percent(plan_.limits) : half_width_percent_)) return false;
    if (!decide_) return true;
    const auto limit = std::ranges::find_if(
        plan_.limits.acuity, [&](const AcuityLimit& row) { return same_contrast(row.delta_t_k, contrast.delta_t_k); });
    if (limit == plan_.limits.acuity.end()) return true;
    const auto expected = expected_uncertainty(contrast, budget_);
    if (!expected) return false;
    const double over = -std::log(*contrast.s75_mrad * limit->least_acuity_per_mrad);
    return 1 - decision_chances(over, *expected, plan_.limits).inconclusive >= decided;
  }

 private:
  const Plan& plan_;
  bool decide_;
  double half_width_percent_;
  const CurveUncertainty* budget_;
};

/// Frames of the measured contrast: the plan's, doubled until their scatter makes at most half of the half-width that
/// the criterion allows; the plan's if 64 times as many are not enough.
Result<int> contrast_frames(const Plan& plan, const ExperimentInputs& inputs, const Criterion& criterion) {
  TODBENCH_TRY(const auto enough, enough_contrast_frames(plan, inputs, [&](ContrastPrediction contrast) {
                 const double twice = 2 * contrast.contrast_half_width;
                 if (!(twice > 0)) return true;
                 contrast.uncertainty_percent = 100 * std::expm1(twice);
                 contrast.se_ln_s75 = twice / contrast.interval_factor;
                 return criterion.met(contrast);
               }));
  return enough.value_or(plan.measurement.contrast_frames);
}

/// Fewest frames of each contrast that meet the criterion; empty: not with most_frames.
Result<std::optional<std::vector<int>>> fewest_frames(Plan plan, const ExperimentInputs& inputs,
                                                      const Criterion& criterion) {
  const std::size_t contrasts = plan.target.delta_t_k.size();
  const bool graded = chosen_answers(plan, inputs.sensor).kind == AnswerKind::graded;
  std::vector<int> low(contrasts, 0), high(contrasts, graded ? most_frames : 1);
  const auto met = [&](const std::vector<int>& frames) -> Result<std::vector<bool>> {
    plan.schedule.frames_per_presentation = frames;
    TODBENCH_TRY(const auto prediction, predict_plan(plan, inputs));
    std::vector<bool> out;
    for (const ContrastPrediction& contrast : prediction.contrasts) out.push_back(criterion.met(contrast));
    return out;
  };
  TODBENCH_TRY(const auto reachable, met(high));
  if (std::ranges::find(reachable, false) != reachable.end()) return std::nullopt;
  const auto open = [&] {
    for (std::size_t i = 0; i < contrasts; ++i) {
      if (high[i] - low[i] > 1) return true;
    }
    return false;
  };
  while (open()) {
    std::vector<int> middle;
    for (std::size_t i = 0; i < contrasts; ++i) middle.push_back((low[i] + high[i] + 1) / 2);
    TODBENCH_TRY(const auto enough, met(middle));
    for (std::size_t i = 0; i < contrasts; ++i) (enough[i] ? high : low)[i] = middle[i];
  }
  return high;
}

Result<PricedDesign> priced(Plan plan, const ExperimentInputs& inputs) {
  TODBENCH_TRY(auto prediction, predict_plan(plan, inputs));
  PricedDesign design{.plan = std::move(plan)};
  Plan laboratory = design.plan;
  if (laboratory.target.kind == TargetKind::scene) laboratory.target.kind = TargetKind::scpi;
  const BenchTime time = expected_bench_time(laboratory, inputs, prediction);
  design.bench_s = time.total_s();
  design.changes_s = time.changes_s;
  design.set_ups = static_cast<int>(time.set_ups);
  design.half_width_percent = prediction.figures.predicted_uncertainty_percent;
  design.contrasts = std::move(prediction.contrasts);
  return design;
}

/// Fewest frames that locate the plate as well as 8 frames of the demonstration do, which is studied: noise of their
/// mean of 0.15 % of the contrast. At most those of the plan. If contrasts change most slowly, set-ups are located at
/// every contrast, otherwise at the highest.
int registration_frames(const Plan& plan, const SensorSpec& sensor) {
  constexpr double noise_share = 0.0015;
  constexpr int fewest = 8;
  const TargetPlan& target = plan.target;
  const bool at_every = target.contrast_change_s > std::min(target.plate_change_s, target.mounting_change_s);
  const auto [lowest, highest] =
      std::ranges::minmax_element(target.delta_t_k, {}, [](double delta_t_k) { return std::abs(delta_t_k); });
  const double needed = std::ceil(std::pow(sensor.netd_k / (noise_share * std::abs(at_every ? *lowest : *highest)), 2));
  const int planned = plan.measurement.registration_frames;
  return needed >= planned ? planned : std::min(planned, std::max(fewest, static_cast<int>(needed)));
}

/// The plan of a candidate, with one frame.
Plan candidate(Plan plan, const std::vector<int>& mountings, int phases) {
  const bool all = std::ranges::all_of(
      mountings, [&](int count) { return count == static_cast<int>(plan.target.mountings.size()); });
  plan.target.mountings_per_plate = all ? std::vector<int>{0} : mountings;
  plan.target.phases = plan.simulation.phases = phases;
  plan.schedule.frames_per_presentation = {1};
  return plan;
}

/// Contrasts that no limit names, except the highest; none if camera and twin are compared.
std::vector<double> not_needed(const Plan& plan) {
  std::vector<double> out;
  if (plan.limits.equivalence_margin_percent || plan.limits.acuity.empty()) return out;
  const double highest = largest_contrast_k(plan.target.delta_t_k);
  for (const double delta_t_k : plan.target.delta_t_k) {
    const bool limited = std::ranges::any_of(
        plan.limits.acuity, [&](const AcuityLimit& limit) { return same_contrast(limit.delta_t_k, delta_t_k); });
    if (!limited && delta_t_k != highest) out.push_back(delta_t_k);
  }
  return out;
}

/// The cheapest candidates, one after another.
class Search {
 public:
  Search(const Plan& plan, const ExperimentInputs& inputs, const Criterion& criterion)
      : plan_(plan), inputs_(inputs), criterion_(criterion) {}

  /// Keeps the candidate if it is faster than the best one with the same mountings, and faster by half a percent than
  /// those before: a smaller gain is not worth a less even share of the plates.
  Result<void> examine(const std::vector<int>& mountings, int phases) {
    const Plan single = candidate(plan_, mountings, phases);
    const std::size_t presentations = set_ups_of(single.target) * static_cast<std::size_t>(phases);
    if (presentations < least_graded_presentations) return {};
    const double single_s = laboratory_time(single, inputs_, {});
    least_s = std::min(least_s, single_s);
    if (best && single_s >= best->bench_s) return {};
    const bool same_set_ups = best && best->plan.target.mountings_per_plate == single.target.mountings_per_plate;
    TODBENCH_TRY(const auto frames, fewest_frames(single, inputs_, criterion_));
    if (!frames) return note_precision(single);
    Plan found = single;
    const bool alike = std::ranges::all_of(*frames, [&](int count) { return count == frames->front(); });
    found.schedule.frames_per_presentation = alike ? std::vector<int>{frames->front()} : *frames;
    TODBENCH_TRY(auto design, priced(std::move(found), inputs_));
    if (!best || design.bench_s < (same_set_ups ? 1 : least_design_gain) * best->bench_s) best = std::move(design);
    return {};
  }

  std::optional<PricedDesign> best{};
  double least_s = std::numeric_limits<double>::infinity();
  std::optional<double> least_percent{};  ///< least half-width of the designs that do not meet the request

 private:
  Result<void> note_precision(Plan plan) {
    if (chosen_answers(plan, inputs_.sensor).kind == AnswerKind::graded)
      plan.schedule.frames_per_presentation = {most_frames};
    TODBENCH_TRY(const auto prediction, predict_plan(plan, inputs_));
    const auto& reached = prediction.figures.predicted_uncertainty_percent;
    if (reached) least_percent = std::min(least_percent.value_or(*reached), *reached);
    return {};
  }

  const Plan& plan_;
  const ExperimentInputs& inputs_;
  const Criterion& criterion_;
};

/// The plan with a settling band, if it settles its contrasts and can do without.
std::optional<Plan> with_settling_band(Plan plan) {
  if (plan.target.contrast_settling_band_percent > 0 || plan.target.contrast_change_s == 0) return std::nullopt;
  plan.target.contrast_settling_band_percent = studied_band_percent;
  if (!check_settling_band(plan, 0).empty()) return std::nullopt;
  return plan;
}

Result<void> examine_all(Search& search, const std::vector<std::vector<int>>& choices, const std::stop_token& stop) {
  for (const std::vector<int>& mountings : choices) {
    for (const int phases : phase_choices) {
      if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      TODBENCH_TRY_VOID(search.examine(mountings, phases));
    }
  }
  return {};
}

/// Time of a ramp in one direction, in s: none shorter is studied, none longer is sensible.
constexpr double shortest_ramp_s = 10, longest_ramp_s = 1200;

/// The plan as a ramp between its contrasts, with the lag that limits its rate; empty if bench or plan admit none.
std::optional<Plan> as_ramp(Plan plan) {
  constexpr double assumed_lag_s = 0.1;
  constexpr int least_phases = 3;  // of no use in a ramp; fewer would make its answers binary
  if (plan.target.contrast_change_s == 0 || plan.target.delta_t_k.empty()) return std::nullopt;
  const auto [to, from] =
      std::ranges::minmax_element(plan.target.delta_t_k, {}, [](double delta_t_k) { return std::abs(delta_t_k); });
  plan.schedule.kind = ScheduleKind::ramp;
  plan.schedule.from_delta_t_k = *from;
  plan.schedule.to_delta_t_k = *to;
  plan.target.contrast_settling_band_percent = 0;
  plan.target.phases = plan.simulation.phases = std::max(least_phases, plan.target.phases);
  if (!plan.target.max_contrast_lag_s) plan.target.max_contrast_lag_s = assumed_lag_s;
  if (!check_schedule_kind(plan, 0).empty() || !check_ramp_to(plan, 0).empty()) return std::nullopt;
  return plan;
}

/// Rates that are compared, in K/s: the largest that the lag of the plate allows, then slower ones in steps of 2 %. The
/// slower ones are the same for every lag, so that a shorter lag never makes the ramp slower.
std::vector<double> ramp_rates(const Plan& ramp) {
  constexpr double step = 1.02;
  const double from_k = *ramp.schedule.from_delta_t_k;
  const double of_1_s = std::abs(from_k) * std::log(from_k / *ramp.schedule.to_delta_t_k);
  const double largest = std::min(largest_ramp_rate(from_k, *ramp.target.max_contrast_lag_s), of_1_s / shortest_ramp_s);
  std::vector<double> rates{largest};
  for (double seconds = shortest_ramp_s; seconds <= longest_ramp_s; seconds *= step) {
    if (of_1_s / seconds < largest) rates.push_back(of_1_s / seconds);
  }
  return rates;
}

struct RatedRamp {
  PricedDesign design;
  bool meets = false;
};

/// The ramp at the fastest of the rates that meets the criterion; if none does in less than `best_s`, at the first one.
Result<RatedRamp> fastest_ramp(Plan ramp, const ExperimentInputs& inputs, const Criterion& criterion, double best_s,
                               const std::stop_token& stop) {
  const std::vector<double> rates = ramp_rates(ramp);
  const auto at = [&](std::size_t rate) -> Result<RatedRamp> {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    ramp.schedule.ramp_k_per_s = rates[rate];
    ramp.schedule.frames_per_presentation = {0};
    TODBENCH_TRY(auto design, priced(with_frames(ramp, inputs), inputs));
    const bool meets = criterion.met(design);
    return RatedRamp{std::move(design), meets};
  };
  TODBENCH_TRY(auto found, at(0));
  // A slower ramp takes longer and has shorter half-widths.
  std::size_t fails = 0, meets = rates.size();
  if (found.meets || found.design.bench_s >= best_s) return found;
  while (meets - fails > 1) {
    const std::size_t middle = (fails + meets) / 2;
    TODBENCH_TRY(auto one, at(middle));
    if (!one.meets && one.design.bench_s >= best_s) break;
    (one.meets ? meets : fails) = middle;
    if (one.meets) found = std::move(one);
  }
  return found;
}

/// The fastest ramp that meets the criterion, in these mountings.
Result<std::optional<RampDesign>> examine_ramps(const Plan& asked, const ExperimentInputs& inputs,
                                                const Criterion& criterion,
                                                const std::vector<std::vector<int>>& choices,
                                                const std::stop_token& stop) {
  const auto ramp = as_ramp(asked);
  if (!ramp) return std::nullopt;
  std::optional<RampDesign> best;
  for (const std::vector<int>& mountings : choices) {
    const double best_s = best && best->meets ? best->design.bench_s : std::numeric_limits<double>::infinity();
    TODBENCH_TRY(auto found,
                 fastest_ramp(candidate(*ramp, mountings, ramp->target.phases), inputs, criterion, best_s, stop));
    // Without any that meets it, the last choice at the largest rate: it has most set-ups.
    if (found.meets ? found.design.bench_s < best_s : (!best || !best->meets))
      best = RampDesign{.design = std::move(found.design),
                        .lag_s = *ramp->target.max_contrast_lag_s,
                        .lag_is_stated = asked.target.max_contrast_lag_s.has_value(),
                        .meets = found.meets};
  }
  return best;
}

Plan without_contrasts(Plan plan, const std::vector<double>& left_out_k) {
  std::vector<double>& contrasts_k = plan.target.delta_t_k;
  std::vector<int>& frames = plan.schedule.frames_per_presentation;
  const bool of_each = frames.size() == contrasts_k.size();
  for (std::size_t i = contrasts_k.size(); i-- > 0;) {
    if (std::ranges::find(left_out_k, contrasts_k[i]) == left_out_k.end()) continue;
    contrasts_k.erase(contrasts_k.begin() + static_cast<std::ptrdiff_t>(i));
    if (of_each) frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return plan;
}

/// Half-widths of an adaptive schedule that are compared, in percent of ln S75, the widest first.
std::vector<double> adaptive_half_widths(const Plan& plan, const DesignRequest& request) {
  constexpr double step = 0.9, finest_percent = 0.1;
  // In whole thousandths, never above the request.
  const auto of_ln = [](double percent) { return std::floor(1e5 * std::log1p(percent / 100)) / 1e3; };
  if (!request.decide)
    return {request.half_width_percent ? of_ln(*request.half_width_percent) : plan.schedule.half_width_percent};
  std::vector<double> out;
  for (double percent = most_percent(plan.limits); percent > finest_percent; percent *= step)
    out.push_back(of_ln(percent));
  return out;
}

/// The fastest adaptive schedule that meets the criterion, in the set-ups of the plan, with its frames of the contrast
/// or with `contrast_frames`. Empty if the plan has another schedule, or if none meets it.
Result<std::optional<PricedDesign>> fastest_adaptive(Plan plan, const ExperimentInputs& inputs,
                                                     const DesignRequest& request, const Criterion& criterion,
                                                     int contrast_frames, const std::stop_token& stop) {
  std::optional<PricedDesign> best;
  if (plan.schedule.kind != ScheduleKind::adaptive) return best;
  const int planned_frames = plan.measurement.contrast_frames;
  for (const double half_width_percent : adaptive_half_widths(plan, request)) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    plan.schedule.half_width_percent = half_width_percent;
    for (const int frames : {planned_frames, contrast_frames}) {
      plan.measurement.contrast_frames = frames;
      TODBENCH_TRY(auto design, priced(plan, inputs));
      if (criterion.met(design) && (!best || design.bench_s < best->bench_s)) best = std::move(design);
    }
    if (best) break;  // a narrower half-width takes longer
  }
  return best;
}

/// Whether a plan keeps the rules of the designs of the search.
bool follows_rules(const PricedDesign& design) {
  const int phases = design.plan.target.phases;
  return design.plan.schedule.kind != ScheduleKind::constant ||
         (phases >= phase_choices.front() && design.set_ups * phases >= static_cast<int>(least_graded_presentations));
}

/// Keeps a design that is faster than all of the search.
void keep_faster(BestDesign& found, Search& search, std::optional<PricedDesign> design) {
  if (!design || (search.best && design->bench_s >= search.best->bench_s)) return;
  const auto adaptive = [](const PricedDesign& one) { return one.plan.schedule.kind == ScheduleKind::adaptive; };
  if (search.best && adaptive(*design) && !adaptive(*search.best)) found.not_adaptive_s = search.best->bench_s;
  found.settled_s.reset();
  search.least_s = std::min(search.least_s, design->bench_s);
  search.best = std::move(design);
}

Error not_found(const Plan& plan, const DesignRequest& request, double half_width_percent, const Search& search,
                const std::string& by_budget) {
  std::string text = request.decide ? fmt::format(
                                          "no design decides every limit for a camera like the simulated one with a "
                                          "probability of {:.0f} %",
                                          100 * decided)
                                    : fmt::format("no design has a half-width of {:.3g} %", half_width_percent);
  const auto& margin = plan.limits.equivalence_margin_percent;
  if (request.decide && margin)
    text += fmt::format(" and has half-widths of {} % or less for the equivalence margin of {:g} %",
                        significant(most_percent(plan.limits), 2), *margin);
  if (!by_budget.empty()) text += ": " + by_budget;
  if (search.least_percent)
    text += fmt::format("{} trials reach {} % at best", by_budget.empty() ? ": the" : ". The",
                        significant(*search.least_percent, 2));
  return Error{ErrorCode::invalid_input, text + ". `todbench plan --decide` shows each limit"};
}

}  // namespace

Result<BestDesign> best_design(const Plan& asked, const ExperimentInputs& inputs, const DesignRequest& request,
                               std::stop_token stop) {
  if (request.decide && asked.limits.acuity.empty())
    return fail(ErrorCode::invalid_input,
                "the plan has no limit on an acuity that a design could decide: state "
                "[[limits.acuity]], or ask for a half-width");
  Plan plan = as_measured(with_frames(asked, inputs));
  if (plan.camera.id.empty()) plan.target.phases = plan.simulation.phases;
  BestDesign found;
  TODBENCH_TRY(found.as_planned, priced(plan, inputs));
  const double half_width_percent =
      request.half_width_percent.value_or(found.as_planned.half_width_percent.value_or(coarsest_percent));
  PlanPrediction expected{.figures = {}, .contrasts = found.as_planned.contrasts, .warnings = {}};
  TODBENCH_TRY(const auto budget, curve_uncertainty(plan, expected_curve(expected), {}, std::nullopt));
  const CurveUncertainty* rows = budget ? &*budget : nullptr;

  plan.schedule.kind = ScheduleKind::constant;
  plan.target.mountings = in_pairs(plan.target.mountings);
  if (request.decide) {
    found.dropped_contrasts_k = not_needed(plan);
    if (plan.limits.equivalence_margin_percent) found.equivalence_half_width_percent = most_percent(plan.limits);
  }
  plan = without_contrasts(std::move(plan), found.dropped_contrasts_k);
  plan.measurement.registration_frames = registration_frames(plan, inputs.sensor);
  const Criterion criterion(plan, request, half_width_percent, rows);
  const std::size_t set_ups = std::min(static_cast<std::size_t>(least_set_ups), set_ups_of(plan.target));
  auto choices = mounting_choices(plan.target.plates.size(), static_cast<int>(plan.target.mountings.size()), set_ups);
  // Few set-ups first: their designs exclude most of the others by their time. Of as many set-ups the even ones first.
  std::ranges::stable_sort(choices, {}, [&](const std::vector<int>& counts) {
    return std::pair(set_ups_of(candidate(plan, counts, 1).target),
                     std::ranges::max(counts) - std::ranges::min(counts));
  });
  Plan settled = plan;
  TODBENCH_TRY(settled.measurement.contrast_frames,
               contrast_frames(candidate(plan, choices.front(), phase_choices.back()), inputs, criterion));
  Search search(settled, inputs, criterion);
  TODBENCH_TRY_VOID(examine_all(search, choices, stop));
  if (const auto moving = with_settling_band(plan)) {
    Search within_band(*moving, inputs, criterion);
    TODBENCH_TRY_VOID(examine_all(within_band, choices, stop));
    search.least_s = std::min(search.least_s, within_band.least_s);
    if (within_band.best && (!search.best || within_band.best->bench_s < least_design_gain * search.best->bench_s)) {
      if (search.best) found.settled_s = search.best->bench_s;
      search.best = std::move(within_band.best);
    }
  }
  TODBENCH_TRY(found.ramp, examine_ramps(plan, inputs, criterion, choices, stop));
  if (found.ramp && found.ramp->meets && found.ramp->lag_is_stated &&
      (!search.best || found.ramp->design.bench_s < least_design_gain * search.best->bench_s)) {
    search.best = found.ramp->design;
    search.least_s = std::min(search.least_s, search.best->bench_s);
  }
  TODBENCH_TRY(auto adaptive, fastest_adaptive(without_contrasts(found.as_planned.plan, found.dropped_contrasts_k),
                                               inputs, request, criterion, settled.measurement.contrast_frames, stop));
  keep_faster(found, search, std::move(adaptive));
  found.planned_meets = criterion.met(found.as_planned);
  if (found.planned_meets && follows_rules(found.as_planned)) keep_faster(found, search, found.as_planned);
  if (!search.best) {
    const std::string by_budget = request.decide ? open_by_budget(plan, found.as_planned.contrasts, rows, decided) : "";
    return tl::unexpected(not_found(plan, request, half_width_percent, search, by_budget));
  }
  found.best = *std::move(search.best);
  found.least_s = search.least_s;
  found.set_ups = found.best.set_ups;
  // The set-ups of an adaptive schedule are known after its run only.
  if (found.best.plan.schedule.kind != ScheduleKind::adaptive)
    found.unpaired_share = unpaired_share(found.best.plan.target);
  return found;
}

}  // namespace todbench
