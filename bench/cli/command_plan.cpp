// SPDX-License-Identifier: GPL-3.0-or-later
// todbench plan
#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/findings.h"
#include "bench/cli/simulation_plan.h"
#include "bench/judgement/verdict.h"
#include "bench/run/acuity_limits.h"
#include "bench/run/comparison_forecast.h"
#include "bench/run/limit_forecast.h"
#include "bench/run/prediction.h"

namespace todbench {
namespace {

void print_plan(const Console& console, const ExperimentInputs& inputs, const PlanPrediction& prediction) {
  std::vector<TableRow> effects;
  for (const auto& d : inputs.effects.decisions) {
    effects.push_back({std::string(to_string(d.effect)), d.decision == Decision::simulate ? "simulate" : "skip",
                       fixed(d.predicted_change_percent, 3), d.reason});
  }
  console.table({"effect", "decision", "change if skipped [%]", "reason"}, effects);
  console.text("");
  std::vector<TableRow> contrasts;
  for (const auto& c : prediction.contrasts)
    contrasts.push_back({fixed(c.delta_t_k, 3), fixed(c.s75_mrad, 3), fixed(c.uncertainty_percent, 1)});
  console.table({"dT [K]", "expected S75 [mrad]", "95 % half-width [%]"}, contrasts);
  console.text("");
  const auto& measured_s = prediction.figures.predicted_measurement_s;
  console.text((measured_s ? "trials of the simulation: " : "trials: ") + std::to_string(prediction.figures.trials) +
               "; uncertainty of S75 (95 %): " + fixed(prediction.figures.predicted_uncertainty_percent, 1) +
               " %; time to simulate on one core of this machine: " + fixed(prediction.figures.predicted_s, 1) + " s" +
               (measured_s ? "; time to measure with the camera: " + fixed(measured_s, 0) + " s" : ""));
}

Json fleet_json(const FleetForecast& fleet) {
  return {{"units", fleet.units},
          {"p_good", json_number(fleet.p_good)},
          {"good_rejected", json_number(fleet.good_rejected)},
          {"good_rejected_most", json_number(fleet.good_rejected_most)},
          {"bad_accepted", json_number(fleet.bad_accepted)},
          {"bad_accepted_most", json_number(fleet.bad_accepted_most)}};
}

Json measure_limits_json(const std::vector<MeasureForecast>& forecasts) {
  Json limits = Json::array();
  for (const MeasureForecast& forecast : forecasts) {
    limits.push_back({{"measure", forecast.measure},
                      {"at_least", json_number(forecast.at_least)},
                      {"at_most", json_number(forecast.at_most)},
                      {"u", json_number(forecast.u)},
                      {"as_before", fleet_json(forecast.as_before)},
                      {"half_u", fleet_json(forecast.half_u)}});
  }
  return limits;
}

Json outlook_json(const LimitOutlook& outlook) {
  Json json{{"u_ln_acuity", json_number(outlook.u_ln_acuity)},
            {"guard_band_ln", json_number(outlook.guard_band_ln)},
            {"p_rejected", json_number(outlook.p_rejected)},
            {"passes_95_from_per_mrad", json_number(outlook.passes_95_from_per_mrad)}};
  if (outlook.fleet) {
    json["consumer_risk"] = json_number(outlook.fleet->consumer_risk);
    json["producer_risk"] = json_number(outlook.fleet->producer_risk);
  }
  if (outlook.earlier) json["fleet"] = fleet_json(*outlook.earlier);
  return json;
}

Json limits_json(const std::vector<LimitForecast>& forecasts) {
  Json limits = Json::array();
  for (const LimitForecast& forecast : forecasts) {
    limits.push_back({{"delta_t_k", forecast.delta_t_k},
                      {"least_acuity_per_mrad", forecast.least_acuity_per_mrad},
                      {"expected_acuity_per_mrad", json_number(forecast.expected_acuity_per_mrad)},
                      {"planned", outlook_json(forecast.planned)},
                      {"four_times_the_presentations", outlook_json(forecast.fourfold)}});
  }
  return limits;
}

Json acuity_limits_json(const std::vector<AcuityLimits>& limits) {
  Json json = Json::array();
  for (const AcuityLimits& at : limits) {
    Json costs = Json::object();
    for (const FactorCost& cost : at.costs) costs[std::string(to_string(cost.factor))] = json_number(cost.percent);
    json.push_back({{"delta_t_k", at.delta_t_k},
                    {"s75_mrad", json_number(at.s75_mrad)},
                    {"limited_by", at.costs.empty() ? Json(nullptr) : Json(to_string(at.costs.front().factor))},
                    {"cost_percent", std::move(costs)}});
  }
  return json;
}

int run_plan(Console& console, SimulationOverrides overrides, bool what_limits, const Program& program) {
  if (program.common.seed_given) overrides.seed = program.common.seed;
  const auto loaded = simulation_plan(overrides, program.stop->token());
  if (!loaded) return report_error(console, loaded.error());
  const Plan& plan = loaded->plan();
  EffectPlanner planner;
  const auto inputs = experiment_inputs(*loaded, planner);
  if (!inputs) return report_error(console, inputs.error());
  auto prediction = predict_plan(plan, *inputs);
  if (!prediction) return report_error(console, prediction.error());
  if (auto timed = predict_times(plan, *inputs, *prediction, program.stop->token()); !timed) {
    if (timed.error().code == ErrorCode::interrupted) return report_error(console, timed.error());
    prediction->warnings.push_back("the time cannot be predicted: " + timed.error().message);
  }
  // If no time can be predicted, a warning already says so.
  const auto frontier = precision_frontier(plan, *inputs, program.stop->token());
  if (!frontier && frontier.error().code == ErrorCode::interrupted) return report_error(console, frontier.error());
  const auto of_camera = predict_plan(as_measured(plan), *inputs);
  if (!of_camera) return report_error(console, of_camera.error());
  const auto limits = limit_forecasts(plan, *of_camera);
  if (!limits) return report_error(console, limits.error());
  const auto measure_limits = measure_forecasts(plan.limits);
  if (!measure_limits) return report_error(console, measure_limits.error());
  std::vector<AcuityLimits> acuity;
  if (what_limits || inputs->observer.eye) {
    auto found = acuity_limits(*inputs, plan.target.delta_t_k, program.stop->token());
    if (!found) return report_error(console, found.error());
    acuity = *std::move(found);
  }
  if (console.json()) {
    Json json = plan_json(inputs->effects, prediction->figures);
    if (!plan.limits.acuity.empty()) json["limits"] = limits_json(*limits);
    if (!measure_limits->empty()) json["measure_limits"] = measure_limits_json(*measure_limits);
    if (!acuity.empty()) json["acuity_limits"] = acuity_limits_json(acuity);
    if (frontier) json["frontier"] = frontier_json(*frontier);
    console.object(json);
  } else {
    print_plan(console, *inputs, *prediction);
    if (frontier) print_frontier(console, *frontier);
    for (const AcuityLimits& at : acuity) console.text(in_words(at));
    for (const LimitForecast& limit : *limits) console.text("limit at " + in_words(limit));
    for (const MeasureForecast& limit : *measure_limits) console.text("limit on " + in_words(limit));
  }
  for (const auto& warning : prediction->warnings) console.note(warning);
  if (inputs->observer.display) {
    if (const auto warning = small_sample_warning(*inputs->observer.display)) console.note(*warning);
  }
  // Without a camera there is no comparison.
  if (!plan.camera.id.empty()) {
    const std::string forecast = comparison_forecast(plan, *prediction).sentence;
    if (!forecast.empty()) console.note(forecast);
  }
  // A plan that cannot find one of its thresholds is inconclusive before it starts.
  return prediction->figures.predicted_uncertainty_percent ? 0 : exit_code(VerdictKind::inconclusive);
}

}  // namespace

void add_plan_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("plan",
                                     "shows which effects are simulated or skipped and why, the number of trials, and "
                                     "the predicted time and uncertainty");
  auto o = std::make_shared<SimulationOverrides>();
  command->add_option("PLAN.toml", o->plan, "plan: name or file")->required();
  add_key_options(*command, OptionOf::simulations, o->keys);
  auto what_limits = std::make_shared<bool>(false);
  command->add_flag("--what-limits", *what_limits,
                    "state what limits the acuity at each contrast; always stated for an observer with an eye");
  finish_command(*command, program,
                 [o, what_limits, &program](Console& console) { return run_plan(console, *o, *what_limits, program); });
}

}  // namespace todbench
