// SPDX-License-Identifier: GPL-3.0-or-later
// todbench picture
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "acquisition/base/machine_memory.h"
#include "acquisition/base/try.h"
#include "bench/cli/chain_options.h"
#include "bench/cli/effect_decisions.h"
#include "bench/cli/result_folder.h"
#include "bench/enhance/package_file.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/plan/descriptions.h"
#include "bench/report/picture_page.h"
#include "bench/session/fit_record.h"
#include "bench/studies/pictured_scenes.h"
#include "bench/studies/scene_pictures.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct PictureArguments {
  std::string scene, out, package;
  ChainOptions chain;
  double range_m = 0, rotation_deg = 0, x_pitch = 0, y_pitch = 0, tolerance_percent = 1;
  std::optional<double> cn2{};
  std::vector<double> motion_mrad_s{};
  int field_pitch = 0;
  bool overwrite = false;
  EffectDecisionOptions decisions;
};

Result<ScenePicturesTask> picture_task(const PictureArguments& a, std::uint64_t seed) {
  ScenePicturesTask task;
  TODBENCH_TRY(auto scene, scene_with_pictures(a.scene));
  TODBENCH_TRY(auto chain, a.chain.load());
  task.scene = std::move(scene);
  task.sensor = std::move(chain.sensor);
  TODBENCH_TRY_VOID(check_picture_memory(task.sensor, machine_memory_bytes()));
  if (a.cn2) {
    task.sensor.turbulence_cn2_m_minus_2_3 = *a.cn2;
    task.sensor.turbulence_path_m = a.range_m;
    if (auto valid = validate(task.sensor); !valid) return fail("--cn2", valid.error());
  }
  task.observer = std::move(chain.observer);
  task.air = std::move(chain.air);
  task.accuracy = chain.accuracy;
  task.view = {.range_m = a.range_m, .rotation_deg = a.rotation_deg, .centre_pitch = {a.x_pitch, a.y_pitch}};
  if (!a.motion_mrad_s.empty()) task.motion = {.x_mrad_s = a.motion_mrad_s[0], .y_mrad_s = a.motion_mrad_s[1]};
  if (!a.package.empty()) {
    TODBENCH_TRY(auto package, read_package_stages(a.package, "the pictures of the stages"));
    task.stages = std::move(package.stages);
  }
  task.effects.tolerance_percent = a.tolerance_percent;
  task.seed = seed;
  task.field_pitch = a.field_pitch;
  return task;
}

std::string grey_sentence(const ScenePictures& pictures) {
  return fmt::format(
      "In every picture black is {:.3g} K and white is {:.3g} K above the background. Values beyond are clipped.",
      pictures.grey_low_k, pictures.grey_high_k);
}

Document picture_document(const ScenePicturesTask& task, const ScenePictures& pictures) {
  ValueTable values{"", {}};
  const auto add = [&](const std::string& name, const std::string& value) {
    values.values.push_back({name, plain(value)});
  };
  add("scene", task.scene.name + (task.scene.description.empty() ? "" : ": " + task.scene.description));
  const int samples = task.sensor.samples_per_pitch();
  add("sensor", fmt::format("{}, {} {} per pitch", task.sensor.name, samples, samples == 1 ? "sample" : "samples"));
  add("range", fmt::format("{:g} m", task.view.range_m));
  if (task.motion.x_mrad_s != 0 || task.motion.y_mrad_s != 0)
    add("motion of the picture",
        fmt::format("{:g} mrad/s to the right, {:g} mrad/s downwards", task.motion.x_mrad_s, task.motion.y_mrad_s));
  add("atmosphere", fmt::format("{}; transmittance {:.4f}", task.air.source.empty() ? task.air.name : task.air.source,
                                pictures.transmittance));
  if (pictures.signature) {
    add("target", fmt::format("{:.3g} m (square root of area), {:.3g} K mean, {:.3g} K spread, {:.3g} K dT_RSS",
                              pictures.signature->size_m(), pictures.signature->mean_dt_k, pictures.signature->sd_k,
                              pictures.signature->dt_rss_k()));
  }
  add("apparent contrast", fmt::format("{:.3g} K", pictures.apparent_dt_k));
  if (const auto& t = pictures.turbulence) {
    add("turbulence",
        fmt::format(
            "Cn2 {:.3g} m^-2/3 over {:g} m: coherence diameter {:.3g} m, long-exposure MTF {:.4f} at the Nyquist "
            "frequency; in short exposures the image moves by {:.2g} pitches (standard deviation) per axis",
            t->path.cn2_m_minus_2_3, t->path.path_m, t->r0_m, t->mtf_at_nyquist, t->tilt_sd_pitch));
  }
  add("background temperature shown by the camera", fmt::format("{:.2f} K", pictures.background_k));
  if (pictures.judged_gain) add("gain of the package", fmt::format("{:.4g}", *pictures.judged_gain));
  add("grey scale", grey_sentence(pictures));
  Table effects{"", {"Effect", "Decision", "Reason"}, {}};
  const auto word = [](Decision decision) { return plain(decision == Decision::simulate ? "simulated" : "skipped"); };
  for (const auto& d : pictures.air)
    effects.rows.push_back({plain("atmosphere: " + d.name), word(d.decision), plain(d.reason)});
  std::string neutral;
  for (const auto& d : pictures.effects.plan.decisions) {
    if (is_of_air(d.effect)) continue;
    if (d.changes_nothing())
      neutral += (neutral.empty() ? "" : ", ") + std::string(to_string(d.effect));
    else
      effects.rows.push_back({plain(to_string(d.effect)), word(d.decision), plain(d.reason)});
  }
  std::vector<Block> blocks{std::move(effects)};
  if (!neutral.empty()) blocks.emplace_back(note(plain("Neutral in this sensor, and therefore skipped: " + neutral)));
  for (const auto& warning : pictures.effects.warnings) blocks.emplace_back(note(plain(warning)));
  const std::string title =
      fmt::format("{} at {:g} m, sensor {}", task.scene.name, task.view.range_m, task.sensor.name);
  return {.title = title,
          .heading = title,
          .subtitle = "Pictures after each stage",
          .page_label = title,
          .opening = {},
          .sections = {{"Scene and sensor", {std::move(values)}}, {"Simulated effects", std::move(blocks)}}};
}

Json picture_json(const ScenePicturesTask& task, const ScenePictures& pictures) {
  Json air = Json::array(), stages = Json::array();
  for (const auto& d : pictures.air) {
    air.push_back(
        {{"name", d.name}, {"decision", d.decision == Decision::simulate ? "simulate" : "skip"}, {"reason", d.reason}});
  }
  for (const auto& stage : pictures.stages) {
    double low = 0, high = 0;
    cv::minMaxLoc(stage.kelvin, &low, &high);
    stages.push_back({{"name", stage.name},
                      {"title", stage.title},
                      {"png", stage.name + ".png"},
                      {"tiff", stage.name + ".tiff"},
                      {"width", stage.kelvin.cols},
                      {"height", stage.kelvin.rows},
                      {"pixels_per_pitch", json_number(stage.pixels_per_pitch)},
                      {"min_k", json_number(low)},
                      {"mean_k", json_number(cv::mean(stage.kelvin)[0])},
                      {"max_k", json_number(high)}});
  }
  Json target;
  if (pictures.signature) {
    target = {{"size_m", json_number(pictures.signature->size_m())},
              {"mean_dt_k", json_number(pictures.signature->mean_dt_k)},
              {"sd_k", json_number(pictures.signature->sd_k)},
              {"dt_rss_k", json_number(pictures.signature->dt_rss_k())}};
  }
  Json turbulence;
  if (const auto& t = pictures.turbulence) {
    turbulence = {{"cn2_m_minus_2_3", t->path.cn2_m_minus_2_3},       {"path_m", t->path.path_m},
                  {"wavelength_um", t->path.wavelength_um},           {"r0_m", json_number(t->r0_m)},
                  {"mtf_at_nyquist", json_number(t->mtf_at_nyquist)}, {"tilt_sd_mrad", json_number(t->tilt_sd_mrad)},
                  {"tilt_sd_pitch", json_number(t->tilt_sd_pitch)}};
  }
  return {
      {"scene", task.scene.name},
      {"sensor", task.sensor.name},
      {"samples_per_pitch", task.sensor.samples_per_pitch()},
      {"range_m", json_number(task.view.range_m)},
      {"motion_mrad_s", {json_number(task.motion.x_mrad_s), json_number(task.motion.y_mrad_s)}},
      {"atmosphere", {{"name", task.air.name}, {"source", task.air.source}, {"decisions", air}}},
      {"turbulence", turbulence},
      {"transmittance", json_number(pictures.transmittance)},
      {"background_k", json_number(pictures.background_k)},
      {"target", target},
      {"apparent_delta_t_k", json_number(pictures.apparent_dt_k)},
      {"grey_scale", {{"black_k", json_number(pictures.grey_low_k)}, {"white_k", json_number(pictures.grey_high_k)}}},
      {"effects", effects_json(pictures.effects.plan)},
      {"judged_gain", json_number(pictures.judged_gain)},
      {"warnings", pictures.effects.warnings},
      {"stages", stages},
      {"frame", {{"png", "frame.png"}, {"tiff", "frame.tiff"}}},
      {"page", "pictures.html"}};
}

/// Writes PNG and TIFF; returns the bytes of the PNG.
Result<std::string> write_one(const std::filesystem::path& folder, const std::string& name, const cv::Mat1f& kelvin,
                              const ScenePictures& pictures, int least_px) {
  auto png = png_of(grey_picture(kelvin, pictures.grey_low_k, pictures.grey_high_k, least_px));
  if (!png) return png;
  const auto tiff = tiff_of(kelvin);
  if (!tiff) return tiff;
  TODBENCH_TRY_VOID(write_file_atomically(folder / (name + ".png"), *png));
  TODBENCH_TRY_VOID(write_file_atomically(folder / (name + ".tiff"), *tiff));
  return png;
}

Result<void> write_pictures(const std::filesystem::path& folder, const ScenePicturesTask& task,
                            const ScenePictures& pictures) {
  std::vector<PagePicture> page;
  for (const auto& stage : pictures.stages) {
    TODBENCH_TRY(const auto png, write_one(folder, stage.name, stage.kelvin, pictures, 512));
    page.push_back({stage.title, stage.note, png});
  }
  if (auto frame = write_one(folder, "frame", pictures.frame, pictures, 1); !frame)
    return tl::unexpected(frame.error());
  const std::string html = page_with_pictures(picture_document(task, pictures), "Stages", page, PicturePlace::first);
  return write_file_atomically(folder / "pictures.html", html);
}

/// Bound of the planner for the effects that the picture leaves out.
std::string promise_of(const ScenePictures& pictures, double tolerance_percent) {
  return fmt::format(
      "the effects that are left out change the acuity at the contrast of the target by at most {:.2g} % "
      "together; {:g} % are allowed",
      pictures.effects.skipped_change_percent, tolerance_percent);
}

int run_picture(Console& console, const PictureArguments& a, std::uint64_t seed) {
  const auto existing = a.overwrite ? ExistingResults::overwritten : ExistingResults::refused;
  if (auto can = check_result_folder(a.out, existing); !can) return report_error(console, can.error());
  auto task = picture_task(a, seed);
  if (!task) return report_error(console, task.error());
  for (const auto& sentence : task->air.notes) console.note(sentence);
  const auto pictures = scene_pictures(*task);
  if (!pictures) return report_error(console, {pictures.error().code, a.scene + ": " + pictures.error().message});
  const DecidedEffects effects{task->sensor.name, pictures->effects.plan, promise_of(*pictures, a.tolerance_percent)};
  if (a.decisions.dry_run) return dry_run(console, {effects}, a.decisions);
  if (auto made = make_result_folder(a.out, existing); !made) return report_error(console, made.error());
  if (auto written = write_pictures(a.out, *task, *pictures); !written) return report_error(console, written.error());
  for (const auto& warning : pictures->effects.warnings) console.note(warning);
  if (console.json()) {
    Json json = picture_json(*task, *pictures);
    json["promise"] = effects.promise;
    console.object(json);
    return 0;
  }
  std::vector<TableRow> rows;
  for (const auto& stage : pictures->stages) {
    double low = 0, high = 0;
    cv::minMaxLoc(stage.kelvin, &low, &high);
    rows.push_back({stage.name, stage.title, fixed(low, 3), fixed(high, 3)});
  }
  console.table({"file", "stage", "minimum [K]", "maximum [K]"}, rows);
  console.text("");
  console.text(fmt::format(
      "transmittance {:.4f}; apparent contrast {:.3g} K; background temperature shown by the camera {:.2f} K",
      pictures->transmittance, pictures->apparent_dt_k, pictures->background_k));
  console.text(grey_sentence(*pictures));
  print_effects(console, effects, a.decisions);
  console.text("page: " + (std::filesystem::path(a.out) / "pictures.html").string());
  return 0;
}

}  // namespace

void add_picture_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("picture", "simulates a scene through atmosphere and camera: one picture after each stage");
  auto a = std::make_shared<PictureArguments>();
  command->add_option("SCENE.toml", a->scene, "scene: name or file")->required();
  a->chain.add_sensor_to(*command);
  command->add_option("--range-m", a->range_m, "distance from the camera to the scene in m")
      ->required()
      ->check(number_in(1e-3, 1e6, "m"));
  command->add_option("--out", a->out, "folder for the pictures and the page")->required();
  a->chain.add_to(*command, "observer of the last stage: name or file");
  command->add_option("--rotation-deg", a->rotation_deg, "rotation of the scene in degrees, clockwise")
      ->check(number_in(-360, 360));
  command
      ->add_option("--x-pitch", a->x_pitch,
                   "position of the scene's origin to the right of the middle of the frame, in detector pitches")
      ->check(number_in(-1e5, 1e5));
  command
      ->add_option("--y-pitch", a->y_pitch,
                   "position of the scene's origin below the middle of the frame, in detector pitches")
      ->check(number_in(-1e5, 1e5));
  command
      ->add_option(
          "--motion-mrad-s", a->motion_mrad_s,
          "motion of the picture to the right and downwards in mrad/s: the target moves, or the camera turns the "
          "other way; smears by time constant and exposure of the sensor")
      ->expected(2)
      ->check(number_in(-1e4, 1e4));
  command->add_option("--package", a->package,
                      "package of stages behind the camera, a file; the lag of the stages is not removed");
  command
      ->add_option("--field-pitch", a->field_pitch,
                   "side of the shown field in detector pitches; default: the target and a margin")
      ->check(whole_number(8, 4096));
  command
      ->add_option("--tolerance-percent", a->tolerance_percent,
                   "largest change of the acuity in percent for which an effect is skipped")
      ->check(number_in(0.01, 50))
      ->capture_default_str();
  command
      ->add_option("--cn2", a->cn2,
                   "structure parameter Cn2 of the turbulence along the path in m^(-2/3); default: that of the sensor")
      ->check(number_in(0, 1e-11));
  command->add_flag("--force", a->overwrite, "overwrites the files in the folder");
  a->decisions.add_to(*command);
  finish_command(*command, program,
                 [a, &program](Console& console) { return run_picture(console, *a, program.common.seed); });
}

}  // namespace todbench
