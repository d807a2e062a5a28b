// SPDX-License-Identifier: GPL-3.0-or-later
// todbench plan
#include <memory>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/effect_decisions.h"
#include "bench/cli/findings.h"
#include "bench/cli/plan_decisions.h"
#include "bench/cli/simulation_plan.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/bill_forecast.h"
#include "bench/forecast/comparison_forecast.h"
#include "bench/forecast/limit_forecast.h"
#include "bench/forecast/prediction.h"
#include "bench/forecast/ramp_advice.h"
#include "bench/judgement/verdict.h"
#include "bench/text/files.h"
#include "bench/twin/acuity_limits.h"
#include "bench/twin/direct_results.h"

namespace todbench {
namespace {

/// Part of the time to measure that is in the bill, and the rest.
std::string beside_bill(const Plan& plan, double measured_s, double bill_s) {
  const double rest_s = measured_s - bill_s;
  if (!(rest_s >= 0)) return "";
  const bool warm_up = plan.camera.warm_up.time_s > 0 || plan.camera.warm_up.drift_k_per_min > 0;
  return " (the bill of " + fixed(bill_s, 1) + " s, and " + fixed(rest_s, 1) + " s of computing" +
         (warm_up ? " and warm-up" : "") + ")";
}

void print_plan(const Console& console, const Plan& plan, const ExperimentInputs& inputs,
                const PlanPrediction& prediction, const std::optional<AccuracyBill>& bill, bool why) {
  print_effect_table(console, inputs.effects, why);
  console.text("");
  std::vector<TableRow> contrasts;
  for (const auto& c : prediction.contrasts)
    contrasts.push_back({fixed(c.delta_t_k, 3), fixed(c.s75_mrad, 3), fixed(c.uncertainty_percent, 1)});
  console.table({"dT [K]", "expected S75 [mrad]", "95 % half-width of 19 in 20 runs, at most [%]"}, contrasts);
  console.text("");
  const auto& measured_s = prediction.figures.predicted_measurement_s;
  console.text((measured_s && plan.schedule.kind != ScheduleKind::ramp ? "trials of the simulation: " : "trials: ") +
               std::to_string(prediction.figures.trials) +
               "; uncertainty of S75 (95 %): " + fixed(prediction.figures.predicted_uncertainty_percent, 1) +
               " %; time to simulate on one core of this machine: " + fixed(prediction.figures.predicted_s, 1) + " s" +
               (measured_s ? "; time to measure with the camera: " + fixed(measured_s, 0) + " s" : "") +
               (measured_s && bill ? beside_bill(plan, *measured_s, bill->total_s) : "") +
               (measured_s && plan.target.kind == TargetKind::scene && plan.measures.any()
                    ? ", without the physical measures, which take as long as this machine needs for their pictures"
                    : ""));
}

void print_bill_forecast(const Console& console, const AccuracyBill& bill) {
  std::vector<TableRow> rows;
  for (const BillRow& row : bill.rows) rows.push_back({row.part, fixed(row.seconds, 1), row.bought});
  rows.push_back({"total", fixed(bill.total_s, 1), ""});
  console.text("");
  console.text("forecast of the bill of the run, without computing:");
  console.table({"part of the run", "time [s]", "result"}, rows);
  for (const std::string& sentence : bill.sentences) console.text(sentence);
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

struct PlanArguments {
  SimulationOverrides overrides;
  bool what_limits = false, decide = false, optimise = false, why = false;
  std::optional<double> half_width_percent;
  std::string out;
};

/// `plan --optimise`.
int run_optimise(Console& console, const PlanArguments& asked, const Plan& plan, const ExperimentInputs& inputs,
                 const Program& program) {
  const auto found = best_design(plan, inputs, {.half_width_percent = asked.half_width_percent, .decide = asked.decide},
                                 program.stop->token());
  if (!found) return report_error(console, found.error());
  if (!asked.out.empty()) {
    if (auto written = write_file_atomically(asked.out, design_toml(*found)); !written)
      return report_error(console, written.error());
  }
  if (console.json()) {
    console.object(best_design_json(*found));
  } else {
    print_design(console, *found);
  }
  return 0;
}

/// What `plan` forecasts of a run.
struct RunForecast {
  PlanPrediction prediction;
  /// Empty if no time can be predicted, which a warning states.
  std::optional<std::vector<PrecisionChoice>> frontier{};
  std::vector<LimitForecast> limits{};
  std::vector<MeasureForecast> measure_limits{};
  std::vector<AcuityLimits> acuity{};
  std::optional<ViewingProposal> viewing{};
  std::optional<AccuracyBill> bill{};
  std::vector<DecisionForecast> decisions{};
};

Result<RunForecast> run_forecast(const PlanArguments& asked, const Plan& plan, const ExperimentInputs& inputs,
                                 const std::stop_token& stop) {
  TODBENCH_TRY(auto prediction, predict_plan(plan, inputs));
  RunForecast out{.prediction = std::move(prediction)};
  if (auto timed = predict_times(plan, inputs, out.prediction, stop); !timed) {
    if (timed.error().code == ErrorCode::interrupted) return tl::unexpected(timed.error());
    out.prediction.warnings.push_back("the time cannot be predicted: " + timed.error().message);
  }
  if (std::string advice = ramp_advice(plan, inputs); !advice.empty())
    out.prediction.warnings.push_back(std::move(advice));
  auto frontier = precision_frontier(plan, inputs, stop, out.prediction.figures);
  if (!frontier && frontier.error().code == ErrorCode::interrupted) return tl::unexpected(frontier.error());
  if (frontier) out.frontier = *std::move(frontier);
  TODBENCH_TRY(const auto of_camera, predict_plan(as_measured(plan), inputs));
  TODBENCH_TRY(out.limits, limit_forecasts(plan, of_camera));
  TODBENCH_TRY(out.measure_limits, measure_forecasts(plan.limits));
  if (asked.what_limits || inputs.observer.eye) {
    TODBENCH_TRY(out.acuity, acuity_limits(plan, inputs, plan.target.delta_t_k, stop));
  }
  TODBENCH_TRY(out.viewing, viewing_of(plan.target.delta_t_k, inputs, stop));
  if (!plan.camera.id.empty() && plan.target.kind != TargetKind::scene) {
    TODBENCH_TRY(out.bill, bill_forecast(plan, inputs));
  }
  if (asked.decide) {
    TODBENCH_TRY(out.decisions, decision_forecasts(plan, inputs));
  }
  return out;
}

Json forecast_json(const RunForecast& forecast, const PlanArguments& asked, const ExperimentInputs& inputs) {
  Json json = plan_json(inputs.effects, forecast.prediction.figures);
  if (!forecast.limits.empty()) json["limits"] = limits_json(forecast.limits);
  if (!forecast.measure_limits.empty()) json["measure_limits"] = measure_limits_json(forecast.measure_limits);
  if (!forecast.acuity.empty()) json["acuity_limits"] = acuity_limits_json(forecast.acuity);
  if (forecast.viewing) json["viewing_proposal"] = viewing_json(*forecast.viewing);
  if (forecast.frontier) json["frontier"] = frontier_json(*forecast.frontier);
  if (forecast.bill) json["bill"] = bill_json(*forecast.bill);
  if (asked.decide) json["decide"] = decisions_json(forecast.decisions);
  return json;
}

void print_forecast(const Console& console, const RunForecast& forecast, const PlanArguments& asked, const Plan& plan,
                    const ExperimentInputs& inputs) {
  print_plan(console, plan, inputs, forecast.prediction, forecast.bill, asked.why);
  if (forecast.frontier) print_frontier(console, *forecast.frontier);
  if (forecast.bill) print_bill_forecast(console, *forecast.bill);
  for (const AcuityLimits& at : forecast.acuity) console.text(in_words(at));
  if (forecast.viewing) console.text(in_words(*forecast.viewing, *inputs.observer.display));
  for (const LimitForecast& limit : forecast.limits) console.text("limit at " + in_words(limit));
  for (const MeasureForecast& limit : forecast.measure_limits) console.text("limit on " + in_words(limit));
  if (asked.decide) print_decisions(console, forecast.decisions, plan.target.kind);
}

/// Warnings and remarks, on standard error.
void note_remarks(Console& console, const RunForecast& forecast, const Plan& plan, const ExperimentInputs& inputs) {
  for (const auto& warning : forecast.prediction.warnings) console.note(warning);
  if (const std::string remark = resume_remark(plan, forecast.bill ? forecast.bill->total_s : 0); !remark.empty())
    console.note(remark);
  if (inputs.observer.display) {
    if (const auto warning = small_sample_warning(*inputs.observer.display)) console.note(*warning);
  }
  // Without a camera there is no comparison.
  if (plan.camera.id.empty()) return;
  const std::string comparison = comparison_forecast(plan, forecast.prediction).sentence;
  if (!comparison.empty()) console.note(comparison);
}

int run_plan(Console& console, const PlanArguments& asked, const Program& program) {
  SimulationOverrides overrides = asked.overrides;
  if (program.common.seed_given) overrides.seed = program.common.seed;
  const auto loaded = simulation_plan(overrides, program.stop->token());
  if (!loaded) return report_error(console, loaded.error());
  const Plan& plan = loaded->plan();
  EffectPlanner planner;
  auto inputs = experiment_inputs(*loaded, planner);
  if (!inputs) return report_error(console, inputs.error());
  if (auto refined = refine_thresholds(*inputs, plan.seed, program.stop->token()); !refined)
    return report_error(console, refined.error());
  if (asked.optimise) return run_optimise(console, asked, plan, *inputs, program);
  const auto forecast = run_forecast(asked, plan, *inputs, program.stop->token());
  if (!forecast) return report_error(console, forecast.error());
  if (console.json()) {
    console.object(forecast_json(*forecast, asked, *inputs));
  } else {
    print_forecast(console, *forecast, asked, plan, *inputs);
  }
  note_remarks(console, *forecast, plan, *inputs);
  // A plan that cannot find one of its thresholds is inconclusive before it starts.
  return forecast->prediction.figures.predicted_uncertainty_percent ? 0 : exit_code(VerdictKind::inconclusive);
}

}  // namespace

void add_plan_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("plan",
                                     "shows which effects are simulated or skipped and why, the number of trials, and "
                                     "the predicted time and uncertainty");
  auto a = std::make_shared<PlanArguments>();
  command->add_option("PLAN.toml", a->overrides.plan, "plan: name or file")->required();
  add_key_options(*command, OptionOf::simulations, a->overrides.keys);
  command->add_flag("--what-limits", a->what_limits,
                    "state what limits the acuity at each contrast; always stated for an observer with an eye");
  command->add_flag("--why", a->why,
                    "state the reason for every effect, also for those that are neutral in the sensor");
  command->add_flag("--decide", a->decide,
                    "state, for each limit on an acuity, the bench time and the probability of each decision, and the "
                    "smallest half-width of the trials that matters beside the uncertainty budget");
  auto* optimise =
      command->add_flag("--optimise", a->optimise,
                        "search the design of least bench time: mountings of each plate, phases, frames of "
                        "each contrast");
  auto* half_width =
      command
          ->add_option("--half-width", a->half_width_percent,
                       "with --optimise: largest half-width of the 95 % interval of S75 at every contrast, in %; "
                       "default: that of the plan")
          ->check(number_in(0.01, 100))
          ->needs(optimise);
  command->get_option("--decide")->excludes(half_width);
  command->add_option("--out", a->out, "with --optimise: write the design to this plan file")->needs(optimise);
  finish_command(*command, program, [a, &program](Console& console) { return run_plan(console, *a, program); });
}

}  // namespace todbench
