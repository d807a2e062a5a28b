// SPDX-License-Identifier: GPL-3.0-or-later
// todbench enhance
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "acquisition/base/try.h"
#include "bench/cli/effect_decisions.h"
#include "bench/cli/findings.h"
#include "bench/cli/result_folder.h"
#include "bench/cli/run_display.h"
#include "bench/cli/session_argument.h"
#include "bench/enhance/decidable.h"
#include "bench/enhance/enhancement_page.h"
#include "bench/enhance/package_spread.h"
#include "bench/enhance/stage_scan.h"
#include "bench/judgement/verdict.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/report/html.h"
#include "bench/run/experiment.h"
#include "bench/session/fit_record.h"
#include "bench/session/trials_csv.h"
#include "bench/text/files.h"
#include "bench/text/spread_text.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

struct EnhanceArguments {
  std::string plan, out = "enhancement";
  std::vector<std::string> packages;
  bool overwrite = false, live = false;
  int dither = 1;
  Opening opening{};
  EffectDecisionOptions decisions;
};

Json enhanced_points_json(const PackageResult& result) {
  Json points = Json::array();
  for (const auto& point : result.curve.points) {
    const auto ratio = std::find_if(result.ratios.begin(), result.ratios.end(),
                                    [&](const auto& r) { return same_contrast(r.set_delta_t_k, point.set_delta_t_k); });
    const bool any = ratio != result.ratios.end();
    const auto judged = judged_point(result, point.set_delta_t_k);
    Json row{{"set_delta_t_k", point.set_delta_t_k},
             {"acuity_per_mrad", json_number(identified_acuity_per_mrad(point))},
             {"acuity_ci95_per_mrad", json_interval(acuity_interval(point.fit.ci95))},
             {"ratio", any ? json_number(ratio->ratio) : Json()},
             {"ratio_ci95", any ? json_interval(ratio->ci95) : Json()},
             {"withheld", any && !ratio->withheld.empty() ? Json(ratio->withheld) : Json()},
             {"verdict", to_string(point.fit.verdict)},
             {"adequacy", adequacy_json(point.adequacy)},
             {"judged_gain", judged ? json_number(judged->gain) : Json()},
             {"judged_noise_k", judged ? json_number(judged->noise_k) : Json()}};
    if (const auto acuity = acuity_spread_per_mrad(point.s75_spread_mrad))
      row["acuity_spread_per_mrad"] = json_interval(*acuity);
    if (any) add_spread(row, "ratio_spread", ratio->spread);
    points.push_back(std::move(row));
  }
  return points;
}

Json enhancement_json(const Enhancement& enhancement, const std::string& folder) {
  Json results = Json::array();
  for (const auto& result : enhancement.results) {
    results.push_back({{"name", result.name},
                       {"points", enhanced_points_json(result)},
                       {"trials", result.trials.size()},
                       {"frames", result.frames},
                       {"frame_ms", json_number(result.frame_ms)},
                       {"clipped_pixels", result.clipped_pixels},
                       {"samples_per_pixel", result.samples_per_pixel},
                       {"error", result.error ? Json(result.error->message) : Json()}});
  }
  return {{"settle_frames", enhancement.settle_frames},
          {"dither", enhancement.dither},
          {"results", results},
          {"camera", enhancement.camera},
          {"warnings", enhancement.warnings},
          {"folder", folder}};
}

Result<void> write_folder(const std::filesystem::path& folder, const LoadedPlan& loaded,
                          const std::vector<EnhancementPackage>& packages, const Enhancement& enhancement) {
  const auto page = render_html(enhancement_page(loaded, packages, enhancement));
  TODBENCH_TRY_VOID(write_file_atomically(folder / "enhancement.html", page));
  const auto json = to_page(enhancement_json(enhancement, folder.string()));
  TODBENCH_TRY_VOID(write_file_atomically(folder / "enhancement.json", json));
  for (std::size_t i = 0; i < enhancement.results.size(); ++i) {
    const auto& result = enhancement.results[i];
    TODBENCH_TRY(auto trials, TrialsWriter::create(folder / fmt::format("trials-{}.csv", i)));
    for (const auto& trial : result.trials) {
      TODBENCH_TRY_VOID(trials.append(trial));
    }
    std::string log;
    for (const auto& line : result.error_lines) log += one_line(line) + '\n';
    if (log.empty()) continue;
    if (auto written = write_file_atomically(folder / fmt::format("package-{}.log", i), log); !written) return written;
  }
  const cv::Mat1b strip = side_by_side(enhancement);
  if (strip.empty()) return {};
  TODBENCH_TRY(const auto png, png_of(strip));
  return write_file_atomically(folder / "pictures.png", png);
}

void say_enhancement(Console& console, const Enhancement& enhancement) {
  const bool with_spread = any_spread(enhancement);
  std::vector<TableRow> rows;
  for (const auto& result : enhancement.results) {
    for (const auto& point : result.curve.points) {
      std::optional<double> ratio;
      Interval interval, spread;
      for (const auto& r : result.ratios) {
        if (!same_contrast(r.set_delta_t_k, point.set_delta_t_k)) continue;
        ratio = r.ratio;
        interval = r.ci95;
        if (r.spread) spread = {r.spread->first, r.spread->second};
      }
      rows.push_back({result.name, fmt::format("{:g}", point.set_delta_t_k),
                      fixed(identified_acuity_per_mrad(point), 3), fixed(ratio, 3), range(interval, 3),
                      fmt::format("{:.3g}", result.frame_ms)});
      if (!with_spread) continue;
      rows.back().push_back(range(acuity_spread_per_mrad(point.s75_spread_mrad).value_or(Interval{}), 3));
      rows.back().push_back(range(spread, 3));
    }
  }
  TableRow header{"package", "set contrast (K)", "acuity (1/mrad)", "ratio", "95 %", "ms/frame"};
  if (with_spread) header.insert(header.end(), {"acuity, open parameters", "ratio, open parameters"});
  console.table(header, rows);
  for (const auto& result : enhancement.results) {
    for (const auto& point : result.curve.points)
      print_findings(console, point.adequacy, fmt::format("{} at {:g} K: ", result.name, point.set_delta_t_k));
  }
}

/// Returns the plan for measuring packages with its camera: all frames are stored, answers are binary, and after a
/// change of the target as many frames are discarded as the longest memory of the packages.
Result<LoadedPlan> live_plan(const EnhanceArguments& a, const std::vector<EnhancementPackage>& packages,
                             const Program& program) {
  auto loaded = read_camera_plan(a.plan);
  if (!loaded) return loaded;
  TODBENCH_TRY_VOID(check_paired_plan(loaded->plan()));
  Plan plan = loaded->plan();
  if (program.common.seed_given) plan.seed = program.common.seed;
  plan.measurement.record_frames = true;
  plan.schedule.answers = AnswersChoice::binary;
  plan.schedule.frames_per_presentation = SchedulePlan{}.frames_per_presentation;
  for (const auto& package : packages)
    plan.measurement.frames_after_change = std::max(plan.measurement.frames_after_change, memory_frames({}, package));
  if (a.dither > 1) {
    if (auto same = check_scans(packages, a.dither); !same) return tl::unexpected(same.error());
    // Single frames show the plate at other places of the pixel. The scan is checked by the packages (ScanWatch).
    plan.target.max_shift_error_px = 0;
    plan.measures = {};
  }
  return loaded->with(std::move(plan));
}

/// Measures with the camera of the plan; returns the folder of the session.
/// `scan`: places of a pixel along each axis that the stage visits in turn.
Result<std::filesystem::path> measured_session(Console& console, const LoadedPlan& loaded,
                                               const std::filesystem::path& folder, ExistingFolder existing, int scan,
                                               const std::stop_token& stop) {
  RunDisplay shown(console, loaded.plan());
  ExperimentOptions options{.folder = folder / "session"};
  options.existing = existing;
  if (scan > 1) {
    TODBENCH_TRY(options.host.on_opened, scan_on_opened(loaded, scan));
  }
  const auto outcome = measure_plan(loaded, options, shown.listener(), stop);
  console.end_progress();
  if (!outcome) return tl::unexpected(outcome.error());
  if (outcome->ended_by) return tl::unexpected(*outcome->ended_by);
  return outcome->folder;
}

/// Effects of the sensor behind the packages. Recorded frames have those of their camera.
Result<DecidedEffects> simulated_effects(const LoadedPlan& loaded, bool recorded) {
  if (recorded) return DecidedEffects{"the camera", {}, "the frames are those of a camera: no effect is simulated"};
  TODBENCH_TRY(const auto inputs, full_inputs(loaded));
  return DecidedEffects{loaded.sensor().name, inputs.effects,
                        "every effect that is not neutral is simulated: the criteria of the planner hold for the "
                        "sensor alone, and a package may amplify an effect that is negligible without it"};
}

int run_enhance(Console& console, const EnhanceArguments& a, const Program& program) {
  std::vector<EnhancementPackage> packages;
  for (const auto& file : a.packages) {
    auto package = read_package(file);
    if (!package) return report_error(console, package.error());
    packages.push_back(*std::move(package));
  }
  std::error_code problem;
  const bool folder_given = std::filesystem::is_directory(a.plan, problem);
  if (a.live && folder_given)
    return report_error(
        console, {ErrorCode::invalid_input, "--live needs a plan with a camera, but " + a.plan + " is a folder"});
  const bool recorded = folder_given || a.live;
  if (folder_given && a.dither > 1)
    return report_error(console, {ErrorCode::invalid_input,
                                  "--dither needs a simulated sensor or --live; recorded frames cannot be dithered"});
  auto loaded = a.live     ? live_plan(a, packages, program)
                : recorded ? recorded_plan(a.plan, a.opening)
                           : read_plan(a.plan);
  if (!loaded) return report_error(console, loaded.error());
  const auto effects = simulated_effects(*loaded, recorded);
  if (!effects) return report_error(console, effects.error());
  if (a.decisions.dry_run) return dry_run(console, {*effects}, a.decisions);
  const std::filesystem::path folder = a.out;
  const auto existing = a.overwrite ? ExistingResults::overwritten : ExistingResults::refused;
  if (auto made = make_result_folder(folder, existing); !made) return report_error(console, made.error());
  const auto stop = program.stop->token();
  std::filesystem::path session = a.plan;
  if (a.live) {
    const auto measured = measured_session(
        console, *loaded, folder, a.overwrite ? ExistingFolder::overwrite : ExistingFolder::refuse, a.dither, stop);
    if (!measured) return report_error(console, measured.error());
    session = *measured;
    loaded = recorded_plan(session, a.opening);
    if (!loaded) return report_error(console, loaded.error());
  }
  const EnhancementOptions options{
      .on_package =
          [&](const std::string& name) { console.phase((recorded ? "measuring with " : "simulating with ") + name); },
      .on_progress = [&](std::size_t done, std::size_t planned) { console.progress(done, planned); },
      .dither = a.dither};
  const auto found = recorded ? compare_packages_recorded(session, *loaded, packages, options, stop)
                              : compare_packages(*loaded, packages, options, stop);
  console.end_progress();
  if (!found) return report_error(console, found.error());
  if (auto written = write_folder(folder, *loaded, packages, *found); !written)
    return report_error(console, written.error());
  if (console.json()) {
    Json json = enhancement_json(*found, folder.string());
    add_effects(json, *effects);
    console.object(json);
  }
  say_enhancement(console, *found);
  print_effects(console, *effects, a.decisions);
  for (const auto& sentence : found->warnings) console.note(sentence);
  console.text("page: " + (folder / "enhancement.html").string());
  int code = 0;
  for (const auto& result : found->results) {
    if (!result.error) {
      for (const TodPoint& point : result.curve.points) {
        if (const auto why = why_undecided(result, point.set_delta_t_k); !why.empty())
          console.text(fmt::format("not fit for a decision: {:g} K: {}", point.set_delta_t_k, why));
      }
      if (code == 0) code = exit_code(result);
      continue;
    }
    console.error(fmt::format("package {}: {} (trials kept: {})", one_line(result.name), result.error->message,
                              result.trials.size()));
    if (code == 0 || code == 3) code = exit_code(result.error->code);
  }
  return code;
}

}  // namespace

void add_enhance_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("enhance", "compares enhancement packages on the same frames, with and without each package");
  auto a = std::make_shared<EnhanceArguments>();
  command
      ->add_option("PLAN", a->plan,
                   "plan whose simulated sensor delivers the frames (with --live, its camera), or session folder with "
                   "recorded frames")
      ->required();
  command->add_option("--packages", a->packages, "files of the packages")->required()->expected(1, 16);
  command->add_option("--out", a->out, "folder for the page, the numbers and the pictures")->capture_default_str();
  command
      ->add_option("--dither", a->dither,
                   "number n of subpixel positions per axis: the simulated sensor (with --live, the stage) visits n x "
                   "n positions in turn, one frame at each")
      ->capture_default_str()
      ->check(whole_number(1, 4));
  command->add_flag(
      "--live", a->live,
      "first measures once with the camera of the plan, into the folder 'session' of --out; the packages process "
      "these frames");
  command->add_flag("--force", a->overwrite, "overwrites the results in an existing folder");
  a->decisions.add_to(*command);
  add_accept_changed(*command, a->opening.accept_changed);
  finish_command(*command, program, [a, &program](Console& console) { return run_enhance(console, *a, program); });
}

}  // namespace todbench
