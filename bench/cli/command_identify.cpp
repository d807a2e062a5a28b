// SPDX-License-Identifier: GPL-3.0-or-later
// todbench identify
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"
#include "bench/cli/chain_options.h"
#include "bench/cli/effect_decisions.h"
#include "bench/cli/identify_people.h"
#include "bench/enhance/package_file.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/descriptions.h"
#include "bench/report/tod_figures.h"
#include "bench/studies/identification_study.h"
#include "bench/studies/pictured_scenes.h"
#include "bench/text/spread_text.h"
#include "bench/text/text.h"
#include "sim_devices/prediction/identification_passes.h"

namespace todbench {
namespace {

struct IdentifyArguments {
  std::string set;
  ChainOptions chain;
  std::vector<double> ranges_m;
  double m75 = 5.1;
  std::optional<double> cn2{};
  int decisions = 2000;
  bool plan = false;
  std::string templates = "camera", cues = "all", sequence = "single-frame";
  std::vector<double> motion_mrad_s{};
  int frames = 8;
  std::string package;
  PeopleOptions people;
  EffectDecisionOptions shown;
};

constexpr std::array template_names{std::pair("camera", TemplateKnowledge::behind_camera),
                                    std::pair("camera-at-rest", TemplateKnowledge::behind_camera_at_rest),
                                    std::pair("ideal", TemplateKnowledge::ideal)};

TemplateKnowledge knowledge_from(const std::string& name) {
  return std::ranges::find_if(template_names, [&](const auto& known) { return name == known.first; })->second;
}

std::string_view templates_name(TemplateKnowledge knowledge) {
  return std::ranges::find_if(template_names, [&](const auto& known) { return knowledge == known.second; })->first;
}

/// Names of the uses of the frames of a pass.
std::vector<std::string> sequence_names() {
  std::vector<std::string> names;
  for (const SequenceObserver observer : identification_sequences) names.emplace_back(to_string(observer));
  return names;
}

/// Pixels from frame to frame.
double pixels_per_frame(const IdentificationStudyTask& task) {
  return cv::norm(step_of_pass(task.sensor, task.motion)) / task.sensor.samples_per_pitch();
}

Result<IdentificationStudyTask> identification_task(const IdentifyArguments& a, const Program& program) {
  IdentificationStudyTask task;
  TODBENCH_TRY(auto set, target_set_with_pictures(a.set));
  TODBENCH_TRY(auto chain, a.chain.load());
  task.set = std::move(set);
  task.sensor = std::move(chain.sensor);
  if (a.cn2) task.sensor.turbulence_cn2_m_minus_2_3 = 0;  // the turbulence of the paths replaces it
  if (a.cn2 > 0.0) {
    SensorSpec behind = task.sensor;
    behind.turbulence_cn2_m_minus_2_3 = task.cn2_m_minus_2_3 = *a.cn2;
    behind.turbulence_path_m = a.ranges_m.back();
    if (auto valid = validate(behind); !valid) return fail("--cn2", valid.error());
  }
  task.observer = std::move(chain.observer);
  task.air = std::move(chain.air);
  task.accuracy = chain.accuracy;
  task.ranges_m = a.ranges_m;
  task.decisions = a.decisions;
  task.knowledge = knowledge_from(a.templates);
  if (!a.motion_mrad_s.empty()) task.motion = {.x_mrad_s = a.motion_mrad_s[0], .y_mrad_s = a.motion_mrad_s[1]};
  task.sequence =
      *std::ranges::find(identification_sequences, a.sequence, [](SequenceObserver s) { return to_string(s); });
  task.frames = a.frames;
  if (!a.package.empty()) {
    TODBENCH_TRY(auto package, read_package_stages(a.package, "identification"));
    task.stage_reach_px = package.reach_px;
    task.stages = std::move(package.stages);
  }
  task.cues = a.cues == "shape" ? TargetCues::shape : TargetCues::all;
  task.m75 = a.m75;
  task.seed = program.common.seed;
  task.stop = program.stop->token();
  return task;
}

std::string spread_text(const std::optional<std::pair<double, double>>& spread, int digits) {
  return spread ? fixed(spread->first, digits) + " to " + fixed(spread->second, digits) : std::string("-");
}

Json criterion_with_spread(const SetCriterion& criterion, const IdentificationStudy& study) {
  Json json = criterion_json(criterion, study.no_m75_because);
  add_spread(json, "spread", criterion.spread);
  return json;
}

/// Wilson's interval for the number of independent answers that gives the scatter of the draws; if all draws agree, for
/// the number of draws.
Interval interval_of(const IdentificationPoint& point) {
  const double p = point.proportion(), variance = std::pow(point.standard_error(), 2);
  const double answers = variance > 0 ? p * (1 - p) / variance : static_cast<double>(point.by_draw.size());
  return wilson_interval(p * answers, answers);
}

Json effort_json(const IdentificationEffort& effort) {
  return {{"decisions", json_number(effort.decisions)},
          {"templates_mb", json_number(effort.largest_bytes / 1e6)},
          {"predicted_s", json_number(effort.processor_s)}};
}

std::string effort_text(const IdentificationEffort& effort) {
  return fmt::format("{:.0f} decisions, at most {:.0f} MB of templates per range, about {:.0f} s of processor time",
                     effort.decisions, effort.largest_bytes / 1e6, std::ceil(effort.processor_s));
}

Json judged_json(const std::optional<JudgedPictures>& judged) {
  if (!judged) return {};
  return {{"gain", json_number(judged->gain)},
          {"gain_of_views", {json_number(judged->least_gain), json_number(judged->largest_gain)}},
          {"noise_k", json_number(judged->noise_k)}};
}

Json identification_json(const IdentificationStudyTask& task, const IdentificationEffort& effort,
                         const IdentificationStudy& study, const std::string& package) {
  Json ranges = Json::array(), names = Json::array(), tod = Json::array();
  for (const auto& target : task.set.targets) names.push_back(target.name);
  Json turbulence;
  if (task.cn2_m_minus_2_3 > 0) turbulence = {{"cn2_m_minus_2_3", task.cn2_m_minus_2_3}};
  for (const auto& point : study.points) {
    Json row{{"range_m", json_number(point.range_m)},
             {"transmittance", json_number(point.transmittance)},
             {"proportion_correct", json_number(point.proportion())},
             {"ci95", json_interval(interval_of(point))},
             {"draws", point.by_draw.size()},
             {"judged", judged_json(point.judged)},
             {"confusion", point.answers}};
    add_spread(row, "proportion_correct_spread", point.spread);
    ranges.push_back(std::move(row));
  }
  for (std::size_t i = 0; i < study.tod.size(); ++i) {
    const TodThreshold& t = study.tod[i];
    Json row{{"delta_t_k", json_number(t.delta_t_k)},
             {"s75_mrad", json_number(t.s75_mrad)},
             {"s75_ci95_mrad", json_interval(t.s75_ci95_mrad)}};
    if (i < study.tod_spread_mrad.size()) add_spread(row, "s75_spread_mrad", study.tod_spread_mrad[i]);
    tod.push_back(std::move(row));
  }
  Json predicted;
  if (study.predicted) {
    predicted = {{"m75", task.m75},
                 {"r75_m", json_number(study.predicted->r75_m)},
                 {"r75_ci95_m", json_interval(study.predicted->r75_ci95_m)},
                 {"reason", study.predicted->reason.empty() ? Json() : Json(study.predicted->reason)}};
    add_spread(predicted, "r75_spread_m", study.predicted_spread_m);
  }
  const auto elements = element_range_m(task.set);
  const bool both = study.predicted && study.predicted->r75_m && study.r75_m.value;
  Json json{{"set", task.set.name},
            {"sensor", task.sensor.name},
            {"samples_per_pitch", task.sensor.samples_per_pitch()},
            {"observer", task.observer.name},
            {"package", package.empty() ? Json() : Json(package)},
            {"templates", templates_name(task.knowledge)},
            {"motion_mrad_s", {json_number(task.motion.x_mrad_s), json_number(task.motion.y_mrad_s)}},
            {"motion_px_per_frame", json_number(pixels_per_frame(task))},
            {"sequence", to_string(task.sequence)},
            {"frames", task.sequence == SequenceObserver::single_frame ? 1 : task.frames},
            {"cues", task.cues == TargetCues::shape ? "shape" : "all"},
            {"atmosphere", {{"name", task.air.name}, {"source", task.air.source}}},
            {"turbulence", turbulence},
            {"planned", effort_json(effort)},
            {"targets", names},
            {"azimuths_deg", task.set.azimuths_deg},
            {"target_pixel_m", elements ? Json{json_number(elements->first), json_number(elements->second)} : Json()},
            {"chance", study.chance},
            {"size_m", json_number(study.size_m)},
            {"dt_rss_k", json_number(study.dt_rss_k)},
            {"ranges", ranges},
            {"r75_m", json_number(study.r75_m.value)},
            {"r75_ci95_m", json_interval(study.r75_m.ci95)},
            {"m75", criterion_with_spread(study.m75, study)},
            {"v50", criterion_with_spread(study.v50, study)},
            {"tod", tod},
            {"predicted", predicted},
            {"measured_over_predicted", both ? Json(*study.r75_m.value / *study.predicted->r75_m) : Json()},
            {"notes", study.notes}};
  add_spread(json, "r75_spread_m", study.r75_m.spread);
  return json;
}

void print_identification(Console& console, const IdentificationStudyTask& task, const IdentificationStudy& study) {
  console.text(fmt::format("{} targets of {}, sensor {}, observer {}; mean size {:.3g} m, mean dT_RSS {:.3g} K",
                           task.set.targets.size(), task.set.name, task.sensor.name, task.observer.name, study.size_m,
                           study.dt_rss_k));
  for (const auto& point : study.points) {
    if (point.judged)
      console.text(
          fmt::format("after the package at {:g} m: contrast multiplied by {:.3g}, noise of a sample {:.3g} K after "
                      "division by this factor",
                      point.range_m, point.judged->gain, point.judged->noise_k));
  }
  if (task.motion.moving())
    console.text(
        fmt::format("motion of the picture: {:g} mrad/s to the right, {:g} mrad/s downwards, {:.3g} pixels per frame",
                    task.motion.x_mrad_s, task.motion.y_mrad_s, pixels_per_frame(task)));
  if (task.sequence != SequenceObserver::single_frame)
    console.text(fmt::format("{} of {} frames", to_string(task.sequence), task.frames));
  std::vector<TableRow> rows;
  TableRow header{"range [m]", "transmittance", "P correct", "95 %"};
  if (task.observer.eye) header.emplace_back("spread of the open parameters");
  for (const auto& point : study.points) {
    rows.push_back({fixed(point.range_m, 0), fixed(point.transmittance, 3), fixed(point.proportion(), 3),
                    range(interval_of(point), 3)});
    if (task.observer.eye) rows.back().push_back(spread_text(point.spread, 3));
  }
  console.table(header, rows);
  console.text("");
  console.text(range_text(study.r75_m, no_r75));
  console.text("criteria of the set: " + criteria_text(study));
  if (task.observer.eye) {
    console.text("over the open parameters of observer " + task.observer.name +
                 " (no confidence interval): " + spread_text(study.r75_m.spread, 1) + " m, M75 " +
                 spread_text(study.m75.spread, 2) + ", V50 " + spread_text(study.v50.spread, 2));
  }
  if (study.predicted) {
    console.text(
        fmt::format("range predicted by the TOD curve with M75 {:g}: ", task.m75) + fixed(study.predicted->r75_m, 1) +
        " m" + (study.predicted->reason.empty() ? "" : "; " + study.predicted->reason) +
        (task.observer.eye ? "; over the open parameters " + spread_text(study.predicted_spread_m, 1) + " m" : ""));
  }
}

int run_identify(Console& console, const IdentifyArguments& a, const Program& program) {
  const auto task = identification_task(a, program);
  if (!task) return report_error(console, task.error());
  for (const auto& sentence : task->air.notes) console.note(sentence);
  const DecidedEffects effects{task->sensor.name, full_plan(task->sensor, {}, {}, task->motion),
                               no_criterion_for("the identification of targets")};
  if (a.shown.dry_run) return dry_run(console, {effects}, a.shown);
  if (a.people.used()) return run_identify_people(console, a.people, *task);
  const auto experiment = experiment_of(*task);
  if (!experiment) return report_error(console, experiment.error());
  const auto effort = planned_effort(*experiment);
  if (!effort) return report_error(console, effort.error());
  if (a.plan) {
    if (console.json()) {
      console.object({{"planned", effort_json(*effort)}});
    } else {
      console.text(effort_text(*effort));
    }
    return exit_code(VerdictKind::pass);
  }
  console.note("planned: " + effort_text(*effort));
  console.phase("simulating the identification of the targets");
  const auto study = study_identification(*task);
  console.end_progress();
  if (!study) return report_error(console, study.error());
  for (const auto& sentence : study->notes) console.note(sentence);
  if (console.json()) {
    Json json = identification_json(*task, *effort, *study, a.package);
    add_effects(json, effects);
    console.object(json);
  } else {
    print_identification(console, *task, *study);
    print_effects(console, effects, a.shown);
  }
  return exit_code(study->r75_m.value ? VerdictKind::pass : VerdictKind::inconclusive);
}

}  // namespace

void add_identify_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "identify", "predicts how well an observer identifies the targets of a set: correct answers by range, M75, V50");
  auto a = std::make_shared<IdentifyArguments>();
  command->add_option("SET.toml", a->set, "set of targets: name or file")->required();
  a->chain.add_sensor_to(*command);
  command->add_option("--ranges", a->ranges_m, "ranges in m, increasing, separated by commas")
      ->required()
      ->delimiter(',')
      ->check(number_in(1e-3, 1e6));
  a->chain.add_to(*command, "observer: name or file");
  command->add_option("--decisions", a->decisions, "number of decisions per target and range")
      ->check(whole_number(16, 1000000))
      ->capture_default_str();
  command
      ->add_option("--templates", a->templates,
                   "templates of the observer: camera (targets as this camera shows them in this motion), "
                   "camera-at-rest (without motion) or ideal (without the blur of the camera)")
      ->check(CLI::IsMember({"camera", "camera-at-rest", "ideal"}))
      ->capture_default_str();
  command
      ->add_option("--cues", a->cues,
                   "differences between targets: all, or shape (all views scaled to one size and one temperature)")
      ->check(CLI::IsMember({"all", "shape"}))
      ->capture_default_str();
  command
      ->add_option(
          "--cn2", a->cn2,
          "structure parameter of the turbulence along the path to every range, in m^(-2/3); default: the value "
          "of the sensor")
      ->check(number_in(0, 1e-11));
  command
      ->add_option("--motion-mrad-s", a->motion_mrad_s,
                   "motion of the picture to the right and downwards in mrad/s: the targets move, or the camera turns "
                   "the other way")
      ->expected(2)
      ->check(number_in(-1e4, 1e4));
  command
      ->add_option("--sequence", a->sequence,
                   "frames that the observer uses: single-frame, tracking-sum (scores of all frames, each at the true "
                   "place) or static-sum (mean of all frames)")
      ->check(CLI::IsMember(sequence_names()))
      ->capture_default_str();
  command->add_option("--frames", a->frames, "frames of a pass for the sums")
      ->check(whole_number(1, 64))
      ->capture_default_str();
  command->add_option("--package", a->package,
                      "package of stages behind the camera, a file; the lag of the stages is not removed");
  a->people.add_to(*command);
  a->shown.add_to(*command);
  command->add_flag("--plan", a->plan, "prints the predicted effort and ends");
  command->add_option("--m75", a->m75, "criterion M75 for the range that the TOD curve predicts")
      ->check(number_in(1e-6, 1e6))
      ->capture_default_str();
  finish_command(*command, program, [a, &program](Console& console) { return run_identify(console, *a, program); });
}

}  // namespace todbench
