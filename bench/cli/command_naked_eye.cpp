// SPDX-License-Identifier: GPL-3.0-or-later
// todbench observer naked-eye
#include "bench/cli/commands.h"

#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "bench/naked_eye/naked_eye_session.h"
#include "bench/plan/descriptions.h"
#include "bench/text/json_fields.h"

namespace todbench {
namespace {

struct NakedEyeArguments {
  std::string plan, from = "hvs-2", person, out;
  NakedEyeTask task{.model = {}};
  int pictures = 48;
};

Result<TemplateObserverSpec> observer_at(const std::string& name, const ViewedDisplay& display) {
  TODBENCH_TRY(auto spec, load_observer_at(name, display));
  TODBENCH_TRY_VOID(require_eye(spec, name));
  return spec;
}

/// Lets an observer answer every picture as a person would.
Result<void> answer_as(const TemplateObserverSpec& person, NakedEyeSession& session, Console& console,
                       const std::stop_token& stop) {
  TemplateObserver observer(person, triangle_alternatives());
  const RandomStream numbers(session.task().seed, "naked-eye.person");
  while (!session.complete()) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "interrupted");
    const NakedEyeTrial& trial = session.trial();
    const NakedEyePicture& picture = session.picture();
    TODBENCH_TRY(const auto prepared, observer.prepare(trial.size_samples, 1));
    const Patch patch{.kelvin = cv::Mat1d(picture.contrast), .phase = trial.centroid, .noise_k = picture.noise};
    const Choice choice = prepared->choose(patch, trial.contrast, numbers.sub(trial.number));
    session.answer(static_cast<Apex>(choice.alternative), 0, std::nullopt);
    console.progress(session.done(), session.planned());
  }
  console.end_progress();
  return session.finish({});
}

void print_prediction(const Console& console, const NakedEyePrediction& prediction) {
  std::vector<TableRow> rows;
  for (const NakedEyeContrast& one : prediction.contrasts) {
    rows.push_back({fixed(one.contrast, 3), fixed(one.s75_mrad, 4),
                    range({one.spread_low_mrad, one.spread_high_mrad}, 4),
                    fixed(one.s75_mrad * 60 * 180 / (1000 * std::numbers::pi), 3)});
  }
  console.table({"contrast", "predicted S75 [mrad]", "spread (no confidence interval)", "[arcmin]"}, rows);
}

void print_comparison(const Console& console, const Json& comparison) {
  std::vector<TableRow> rows;
  for (const Json& one : comparison["contrasts"]) {
    const auto number = [](const Json& value) { return value.is_number() ? fixed(value.get<double>(), 4) : "-"; };
    rows.push_back({fixed(one["contrast"].get<double>(), 3), number(one["predicted_s75_mrad"]), number(one["s75_mrad"]),
                    one["s75_ci95_mrad"].is_array()
                        ? number(one["s75_ci95_mrad"][0]) + " to " + number(one["s75_ci95_mrad"][1])
                        : "-",
                    one["inside_spread"].is_boolean() ? (one["inside_spread"].get<bool>() ? "yes" : "no") : "-"});
  }
  console.table({"contrast", "predicted S75 [mrad]", "S75 [mrad]", "95 %", "inside the spread"}, rows);
}

int run_naked_eye(Console& console, NakedEyeArguments a, const Program& program) {
  const auto plan = load_plan(a.plan);
  if (!plan) return report_error(console, plan.error());
  if (!has_display(*plan))
    return report_error(console, {ErrorCode::invalid_input, a.plan + ": the plan has no section [display]"});
  auto model = observer_at(a.from, plan->display);
  if (!model) return report_error(console, model.error());
  a.task.model = *std::move(model);
  a.task.seed = program.common.seed;
  console.phase("predicting");
  auto session = NakedEyeSession::begin(a.task, a.out, a.pictures, program.stop->token());
  if (!session) return report_error(console, session.error());
  if (!a.person.empty()) {
    const auto person = observer_at(a.person, linear_display(plan->display));
    if (!person) return report_error(console, with_context("--person", person.error()));
    console.phase("answering");
    if (auto done = answer_as(*person, *session, console, program.stop->token()); !done)
      return report_error(console, done.error());
  }
  if (console.json()) {
    Json json{{"folder", a.out}, {"planned", session->planned()}, {"answers", session->done()}};
    json["prediction"] = printed_json(session->prediction(), prediction_fields);
    if (!a.person.empty()) json["comparison"] = session->comparison();
    console.object(json);
    return 0;
  }
  print_prediction(console, session->prediction());
  if (!a.person.empty()) print_comparison(console, session->comparison());
  console.text("session: " + a.out);
  return 0;
}

}  // namespace

void add_naked_eye_command(CLI::App& observer, Program& program) {
  auto* command = observer.add_subcommand(
      "naked-eye",
      "predicts the answers of a person to triangles on a display without camera and sensor, and simulates a person. "
      "People answer on the page Human of the window");
  auto a = std::make_shared<NakedEyeArguments>();
  command->add_option("PLAN", a->plan, "plan, name or file, whose section [display] describes the calibrated display")
      ->required();
  command->add_option("--out", a->out, "folder of the new session")->required();
  command->add_option("--contrasts", a->task.contrasts, "luminance contrasts of the triangles, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--noise", a->task.noise,
                   "standard deviation of white noise per displayed sample, as a luminance contrast")
      ->capture_default_str();
  command->add_option("--per-size", a->task.per_size, "triangles per contrast and size")
      ->check(whole_number(4, 10000))
      ->capture_default_str();
  command->add_option("--from", a->from, "observer that predicts, with an eye: name or file")->capture_default_str();
  command->add_option("--person", a->person, "observer with an eye that answers as a person would: name or file");
  command->add_option("--pictures", a->pictures, "pictures of each size for the prediction")
      ->check(whole_number(16, 4096))
      ->capture_default_str();
  finish_command(*command, program, [a, &program](Console& console) { return run_naked_eye(console, *a, program); });
}

}  // namespace todbench
