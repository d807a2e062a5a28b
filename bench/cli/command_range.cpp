// SPDX-License-Identifier: GPL-3.0-or-later
// todbench range
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/findings.h"
#include "bench/cli/range_options.h"
#include "bench/cli/session_argument.h"
#include "bench/judgement/verdict.h"
#include "bench/range/turbulent_ranges.h"
#include "bench/session/fit_record.h"
#include "bench/studies/people_set.h"
#include "bench/text/spread_text.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "tod/range/range_prediction.h"

namespace todbench {
namespace {

struct RangeArguments {
  std::string tod;
  RangeTask task;
  std::optional<double> m75, v50;
  std::string m75_of;
  RangeOptions more;
  Opening opening{};
};

/// Result of the TOD model and the source of its curve.
struct TodAnswer {
  RangePrediction prediction;
  std::string observer, sensor;
  std::optional<double> twin_r75_m;
};

/// Whether the TOD curve gives a probability for the target at any range.
bool any_probability(const RangePrediction& prediction) {
  return std::any_of(prediction.curve.begin(), prediction.curve.end(),
                     [](const RangePoint& point) { return point.probability.has_value(); });
}

Json range_json(const TodAnswer& tod, const RangeTask& task, const RangeQuestion& question) {
  const RangePrediction& prediction = tod.prediction;
  const double u_percent = question.m75_u_percent;
  const std::string m75_origin = criterion_origin(question, RangeModel::tod);
  Json points = Json::array();
  const std::vector<RangePoint> none;
  for (const auto& point : any_probability(prediction) ? prediction.curve : none) {
    points.push_back({{"range_m", point.range_m},
                      {"probability", json_number(point.probability)},
                      {"probability_ci95", json_interval(point.probability_ci95)},
                      {"apparent_delta_t_k", json_number(point.apparent_delta_t_k)}});
  }
  Json json{{"r75_m", json_number(prediction.r75_m)},
            {"r75_ci95_m", json_interval(prediction.r75_ci95_m)},
            {"reason", prediction.reason.empty() ? Json() : Json(prediction.reason)},
            {"adequacy", adequacy_json(prediction.adequacy)},
            {"notes", prediction.notes},
            {"observer", tod.observer},
            {"sensor", tod.sensor},
            {"size_m", task.size_m},
            {"delta_t_k", task.delta_t_k},
            {"m75", task.m75},
            {"m75_ci95", u_percent > 0 ? json_interval(Interval{task.m75 * std::exp(-normal_z95 * u_percent / 100),
                                                                task.m75 * std::exp(normal_z95 * u_percent / 100)})
                                       : Json()},
            {"m75_origin", m75_origin},
            {"extinction_per_km", task.extinction_per_km},
            {"curve", points}};
  add_spread(json, "r75_spread_m", prediction.r75_spread_m);
  return json;
}

void print_range(Console& console, const TodAnswer& tod, const RangeTask& task, const RangeQuestion& question,
                 const Atmosphere& air) {
  const RangePrediction& prediction = tod.prediction;
  console.text("identification range, TOD of " + tod.sensor + ", observer " + tod.observer);
  const std::string through =
      task.air ? "atmosphere: " + air.source : "extinction " + number_text(task.extinction_per_km) + " per km";
  console.text("target " + number_text(task.size_m) + " m, " + number_text(task.delta_t_k) + " K, M75 " +
               number_text(task.m75) + ", " + through);
  console.text("M75: " + criterion_origin(question, RangeModel::tod));
  std::vector<TableRow> rows;
  for (const auto& p : prediction.curve) {
    if (!p.probability) continue;
    rows.push_back(
        {fixed(p.range_m, 0), fixed(p.apparent_delta_t_k, 3), fixed(p.probability, 3), range(p.probability_ci95, 3)});
  }
  if (!rows.empty()) {
    console.table({"range [m]", "apparent dT [K]", "P correct", "95 %"}, rows);
    console.text("");
  }
  if (prediction.r75_m || prediction.r75_ci95_m.low)
    console.text("75 % correct at " + fixed(prediction.r75_m, 1) + " m, 95 %: " + range(prediction.r75_ci95_m, 1) +
                 " m");
  if (prediction.r75_spread_m) console.text("75 % correct at " + spread_in_words(*prediction.r75_spread_m, "m"));
  if (!prediction.reason.empty()) console.text(prediction.reason);
  print_findings(console, prediction.adequacy, "the TOD curve ");
}

/// Predicts from the thresholds; without thresholds the result contains the reason.
Result<RangePrediction> predicted(const ThresholdSelection& selection, const RangeTask& task) {
  RangePrediction prediction;
  if (!selection.thresholds.empty()) return predict_range(selection.thresholds, task);
  prediction.reason = "the TOD curve has no threshold";
  return prediction;
}

Result<TodAnswer> tod_answer(const Session& session, const ThresholdSelection& selection, const RangeTask& task) {
  TODBENCH_TRY(auto prediction, predicted(selection, task));
  prediction.notes.insert(prediction.notes.begin(), selection.notes.begin(), selection.notes.end());
  TodAnswer answer{std::move(prediction), session.curve->observer, session.curve->sensor, {}};
  if (session.twin) {
    const auto twin = predicted(thresholds_of(*session.twin, task.delta_t_k), task);
    if (twin) answer.twin_r75_m = twin->r75_m;
  }
  return answer;
}

Result<std::optional<Session>> session_of(Console& console, const RangeArguments& arguments) {
  if (arguments.tod.empty()) {
    if (!arguments.more.asks(RangeModel::tod)) return std::nullopt;
    return fail(ErrorCode::invalid_input, "range: --tod is required for the TOD model");
  }
  auto session = opened(console, arguments.tod, arguments.opening);
  if (!session) return tl::unexpected(session.error());
  if (!session->curve && arguments.more.asks(RangeModel::tod))
    return fail(ErrorCode::invalid_input, arguments.tod + ": the session has no TOD curve");
  return std::optional(*std::move(session));
}

/// Sets the contrast at the scale of the NETD and the air in the task.
Result<Atmosphere> into_task(RangeTask& task, const RangeOptions& options, const std::optional<SensorSpec>& sensor) {
  auto air = options.air(sensor, task.extinction_per_km);
  if (!air) return air;
  if (options.has_table()) task.air = air->air;
  TODBENCH_TRY(task.delta_t_k, options.equivalent_contrast_k(task.delta_t_k, sensor, *air));
  return air;
}

/// Relative uncertainty of the rows of the budget for the angle of a pixel.
double relative_u_of_ifov(const Plan& plan) {
  double sum = 0;
  for (const BudgetRow& row : plan.uncertainty.rows) {
    const BudgetUnit unit = budget_unit(InputKind::geometry, row.unit).value_or(BudgetUnit{});
    if (input_of(row) != BudgetInput::ifov || row.sensitivity || !unit.relative) continue;
    sum = std::hypot(sum, standard_of(row) * unit.factor);
  }
  return sum;
}

/// Results behind turbulence, with the decision about it.
struct TurbulentAnswers {
  std::vector<ModelRange> models;
  TurbulenceDecision decision;
  std::optional<TurbulentPath> at_r75;  ///< of the first model with a range
};

Result<TurbulentAnswers> through_turbulence(const RangeOptions& options, const RangeTask& task,
                                            const RangeQuestion& question, const RangeSources& sources,
                                            const std::optional<Session>& session, TodAnswer& tod) {
  TODBENCH_TRY(const auto still, range_models(options.models, sources, question));
  double longest_m = tod.prediction.r75_ci95_m.high.value_or(tod.prediction.r75_m.value_or(0));
  for (const auto& model : still) {
    for (const auto& range_m : {model.r75_m, model.r50_m, model.r75_ci95_m.high})
      longest_m = std::max(longest_m, range_m.value_or(0));
  }
  if (!sources.sensor) return fail(ErrorCode::invalid_input, "--cn2 needs a sensor: add --sensor or --tod");
  TurbulentAnswers out;
  out.decision =
      decide_turbulence(*sources.sensor, options.cn2, question, tod.prediction.r75_m, options.tolerance_percent);
  const bool simulated = out.decision.simulated && !sources.thresholds.empty() && session;
  TODBENCH_TRY(const auto behind,
               TurbulentSources::of(sources, simulated ? std::optional(session->parts.observer) : std::nullopt,
                                    options.cn2, std::max(2.2 * longest_m, 1.0)));
  if (simulated) {
    auto notes = std::move(tod.prediction.notes);
    const bool still_has_spread = tod.prediction.r75_spread_m.has_value();
    TODBENCH_TRY(tod.prediction, turbulent_prediction(behind, sources.thresholds, task));
    tod.prediction.notes = std::move(notes);
    if (still_has_spread)
      tod.prediction.notes.emplace_back(
          "no spread of the range over the open parameters of the observer: the effect of the turbulence is computed "
          "only for the nominal parameters");
    if (tod.twin_r75_m) {
      const auto twin = turbulent_prediction(behind, thresholds_of(*session->twin, task.delta_t_k).thresholds, task);
      tod.twin_r75_m = twin ? twin->r75_m : std::nullopt;
    }
  }
  TODBENCH_TRY(out.models, turbulent_range_models(options.models, behind, question));
  for (const auto& model : out.models) {
    if (!out.at_r75 && model.r75_m) out.at_r75 = turbulent_path(behind.sensor_at(*model.r75_m));
  }
  return out;
}

/// Sentences of the page besides the models: about the TOD curve, its adequacy, and turbulence.
std::vector<std::string> sentences_of(const RangePrediction& tod, const TurbulenceDecision* turbulence,
                                      const RangeOptions& options) {
  std::vector<std::string> said;
  if (options.asks(RangeModel::tod)) {
    said = tod.notes;
    if (tod.adequacy) {
      for (const auto& finding : tod.adequacy->findings)
        said.push_back((finding.unfit ? "Not fit for a decision: the TOD curve " : "The TOD curve ") +
                       finding.sentence);
    }
  }
  if (turbulence != nullptr) {
    said.push_back(
        fmt::format("Turbulence with Cn2 = {:g} m^(-2/3) acts along the whole path at every range", options.cn2) +
        (options.asks(RangeModel::tod) ? "; TOD: " + turbulence->reason : ""));
  }
  return said;
}

Json turbulence_json(const TurbulentAnswers& answers, const SensorSpec& sensor, double cn2) {
  Json json{{"cn2_m_minus_2_3", cn2},
            {"decision", answers.decision.simulated ? "simulate" : "skip"},
            {"bound_percent", json_number(answers.decision.bound_percent)},
            {"reason", answers.decision.reason},
            {"path_m", nullptr}};
  if (const auto& path = answers.at_r75) {
    json["path_m"] = path->path_m;
    json["r0_m"] = json_number(fried_spherical_m(*path));
    json["mtf_at_nyquist"] =
        json_number(long_exposure_mtf(*path, 0.5 * sensor.samples_per_pitch() / sensor.ifov_mrad()));
    json["tilt_sd_mrad"] = json_number(tilt_sd_mrad(*path, sensor.focal_length_mm / sensor.f_number / 1000));
  }
  return json;
}

/// M75 with its uncertainty from a file. Error: `invalid_input` for the curve of another observer, or without interval.
Result<void> take_m75(const std::string& file, const std::string& curve_observer, RangeTask& task,
                      RangeOptions& options) {
  TODBENCH_TRY(const auto stated, read_m75_file(file));
  if (stated.curve_of != curve_observer) {
    return fail(ErrorCode::invalid_input,
                fmt::format("--m75-of: the M75 belongs to the TOD curve of {}, and the curve of the session is that of "
                            "{}: judge the session with {}, or evaluate the answers with --observer {}",
                            stated.curve_of, curve_observer, stated.curve_of, curve_observer));
  }
  if (!stated.ci95.low || !stated.ci95.high)
    return fail(ErrorCode::invalid_input,
                "--m75-of: the M75 has no interval on both sides, so the range would have none");
  task.m75 = stated.m75;
  // The larger side: the interval of a range is never too short.
  const double wider = std::max(std::log(*stated.ci95.high / stated.m75), std::log(stated.m75 / *stated.ci95.low));
  options.m75_u_percent = 100 * wider / normal_z95;
  options.criterion_source = CriterionSource::m75_file;
  options.m75_observer = fmt::format("{} who identified the targets of {}, on the TOD curve of {}", stated.answers_of,
                                     stated.set, stated.curve_of);
  return {};
}

/// What is asked, with the session, the sensor and the air that it names.
struct RangeInputs {
  RangeTask task;
  RangeOptions options;
  std::optional<double> v50{};
  std::optional<Session> session{};
  std::optional<SensorSpec> sensor{};
  Atmosphere air{};

  /// The session's TOD curve; null without one.
  [[nodiscard]] const TodCurve* curve() const { return session && session->curve ? &*session->curve : nullptr; }
};

Result<RangeInputs> inputs_of(Console& console, const RangeArguments& arguments) {
  RangeInputs in{.task = arguments.task, .options = arguments.more, .v50 = arguments.v50};
  in.options.asked_delta_t_k = in.task.delta_t_k;
  if (in.options.transfer && !in.options.asks(RangeModel::mtdp))
    return fail(ErrorCode::invalid_input, "range: --tod-transfer changes the mtdp model only: add it to --models");
  if (arguments.v50) in.task.m75 = m75_from_v50(*arguments.v50);
  if (arguments.m75) in.task.m75 = *arguments.m75;
  in.options.criterion_source = arguments.v50   ? CriterionSource::v50_stated
                                : arguments.m75 ? CriterionSource::m75_stated
                                                : CriterionSource::published;
  TODBENCH_TRY(in.session, session_of(console, arguments));
  if (in.options.transfer && in.session &&
      (!in.session->plan.modules.empty() || !in.session->parts.sensor.modules.empty()))
    return fail(ErrorCode::invalid_input, "range: --tod-transfer was not studied for pictures or answers of modules");
  TODBENCH_TRY(in.sensor, in.options.sensor_of(in.session));
  TODBENCH_TRY(in.air, into_task(in.task, in.options, in.sensor));
  for (const auto& sentence : in.air.notes) console.note(sentence);
  if (arguments.m75_of.empty()) return in;
  if (in.curve() == nullptr) return fail(ErrorCode::invalid_input, "--m75-of needs the TOD curve of a session (--tod)");
  TODBENCH_TRY_VOID(take_m75(arguments.m75_of, in.curve()->observer, in.task, in.options));
  return in;
}

struct RangeAnswers {
  TodAnswer tod;
  RangeQuestion question;
  RangeSources sources;
  std::optional<TurbulentAnswers> turbulent;
  std::vector<ModelRange> models;
  Json grid;
  std::string observers;  ///< how the observers of the criterion and of the curve differ; may be empty
};

Result<RangeAnswers> answers_of(Console& console, RangeInputs& in) {
  RangeAnswers out;
  ThresholdSelection selection;
  if (in.curve() != nullptr) {
    selection = thresholds_of(*in.curve(), in.task.delta_t_k);
    TODBENCH_TRY(out.tod, tod_answer(*in.session, selection, in.task));
  } else {
    out.tod.prediction.reason = "no TOD curve is given (--tod)";
  }
  RangePrediction& prediction = out.tod.prediction;
  for (const auto& sentence : prediction.notes) console.note(sentence);
  in.options.curve_observer = out.tod.observer;
  out.question = in.options.question(in.task, in.v50, in.air);
  if (prediction.r75_m) {
    prediction.r75_ci95_m = joined_with_m75(selection.thresholds, in.task, *prediction.r75_m, prediction.r75_ci95_m,
                                            out.question.m75_u_percent);
  }
  if (in.options.asks(RangeModel::tod)) out.observers = observers_differ(out.question);
  if (!out.observers.empty()) console.note(out.observers);
  if (in.session && in.session->uncertainty) {
    const CurveUncertainty& budget = *in.session->uncertainty;
    out.question.scale_u_percent = 100 * std::hypot(budget.u_scale, budget.u_camera_scale);
    out.question.ifov_u_percent = 100 * relative_u_of_ifov(in.session->plan);
  }
  TODBENCH_TRY(out.sources, in.options.sources(selection.thresholds, in.sensor));
  if (in.options.cn2 > 0) {
    TODBENCH_TRY(out.turbulent,
                 through_turbulence(in.options, in.task, out.question, out.sources, in.session, out.tod));
    if (in.options.asks(RangeModel::tod)) console.note("turbulence: " + out.turbulent->decision.reason);
    out.models = out.turbulent->models;
  } else {
    TODBENCH_TRY(out.models, range_models(in.options.models, out.sources, out.question));
  }
  TODBENCH_TRY(out.grid, in.options.grid_json(out.sources, out.question, in.sensor));
  return out;
}

Json answers_json(const RangeInputs& in, const RangeAnswers& answers) {
  Json json = range_json(answers.tod, in.task, answers.question);
  json["delta_t_k"] = in.options.asked_delta_t_k;
  json["atmosphere"] = atmosphere_json(in.air, in.task, answers.tod.prediction.r75_m, in.options, in.sensor);
  json["models"] = models_json(answers.models, answers.sources, answers.question, answers.tod.twin_r75_m);
  if (answers.turbulent) {
    json["turbulence"] = turbulence_json(*answers.turbulent, *answers.sources.sensor, in.options.cn2);
    // Both forms of P are those of the curve without turbulence.
    if (json["models"].contains("ttp")) json["models"]["ttp"].erase("forms");
  }
  if (!answers.grid.is_null()) json["grid"] = answers.grid;
  return json;
}

int run_range(Console& console, const RangeArguments& arguments) {
  auto in = inputs_of(console, arguments);
  if (!in) return report_error(console, in.error());
  auto answers = answers_of(console, *in);
  if (!answers) return report_error(console, answers.error());
  RangePrediction& tod = answers->tod.prediction;
  auto said = sentences_of(tod, answers->turbulent ? &answers->turbulent->decision : nullptr, in->options);
  // The page has it among the notes of the model.
  if (!answers->observers.empty()) tod.notes.push_back(answers->observers);
  const std::string accepted = in->session ? accepted_sentence(arguments.tod, *in->session) : "";
  if (!accepted.empty()) said.push_back(accepted);
  if (auto written = in->options.write(answers->models, answers->question, said, answers->grid); !written)
    return report_error(console, written.error());
  if (console.json()) {
    Json json = answers_json(*in, *answers);
    if (in->session) add_accepted_changes(json, arguments.opening, in->session->accepted_changes);
    console.object(json);
  } else {
    if (in->options.asks(RangeModel::tod)) print_range(console, answers->tod, in->task, answers->question, in->air);
    if (in->options.models.size() > 1 || !in->options.asks(RangeModel::tod)) print_models(console, answers->models);
    if (!answers->grid.is_null()) print_grid(console, answers->grid);
    if (!accepted.empty()) console.text(accepted);
  }
  const bool all = std::ranges::all_of(answers->models, [](const auto& model) { return model.r75_m.has_value(); });
  const bool fit = !tod.adequacy || tod.adequacy->adequate();
  return exit_code(all && fit ? VerdictKind::pass : VerdictKind::inconclusive);
}

}  // namespace

void add_range_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "range", "predicts identification ranges from a TOD curve, and from other models for comparison");
  auto a = std::make_shared<RangeArguments>();
  command->add_option("--tod", a->tod, "session folder with the TOD curve; required if --models includes tod");
  command->add_option("--size-m", a->task.size_m, "square root of the projected area of the target, in m")
      ->required()
      ->check(number_in(1e-3, 1000, "m"));
  command->add_option("--delta-t-k", a->task.delta_t_k, "contrast of the target in K")
      ->required()
      ->check(number_in(-5000, 5000, "k"));
  auto* m75 =
      command
          ->add_option("--m75", a->m75, "criterion M75 of the TOD model; 5.1 is that of small craft seen from the side")
          ->check(number_in(1e-6, 1e6))
          ->default_str("5.1");
  command->add_option("--v50", a->v50, "criterion V50 of NVThermIP in place of --m75: M75 = 0.6 V50")
      ->check(number_in(1e-6, 1e6))
      ->excludes(m75);
  command->add_option("--extinction-per-km", a->task.extinction_per_km, "extinction of the apparent contrast in 1/km")
      ->check(number_in(0, 1e4))
      ->capture_default_str();
  a->more.add_to(*command);
  auto* m75_of = command->add_option("--m75-of", a->m75_of,
                                     "file with the M75 of people and its interval, by todbench identify --m75-out");
  for (const char* other : {"--m75", "--v50", "--m75-u-percent"}) m75_of->excludes(command->get_option(other));
  add_accept_changed(*command, a->opening.accept_changed);
  finish_command(*command, program, [a](Console& console) { return run_range(console, *a); });
}

}  // namespace todbench
