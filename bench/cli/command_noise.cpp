// todbench noise
#include <algorithm>
#include <chrono>
#include <memory>

#include "acquisition/core/camera_id.h"
#include "acquisition/recording/recording_backend.h"
#include "bench/cli/commands.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/descriptions.h"
#include "bench/studies/real_noise_study.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

struct NoiseArguments {
  std::string recording;
  std::string sensor = "sc2000", observer = "hvs-1";
  int block_frames = 10;
  RealNoiseOptions study;
};

/// Neighbours that correlate by more than this change together: the scene moved, and nothing of it is the camera's
/// noise.
constexpr double moved_scene = 0.8;

struct Frames {
  std::vector<cv::Mat1f> pictures;
  bool kelvin = false;
};

/// All complete frames, in kelvin where the recording says how, else in counts.
Result<Frames> frames_of(const std::string& id) {
  auto source =
      recording_backend()->open(has_scheme(id, camera_scheme::file) ? id : camera_id(camera_scheme::file, id));
  // Here a recording is an input file and no device.
  if (!source) return fail(ErrorCode::invalid_input, source.error().message);
  if (auto started = (*source)->start(); !started) return tl::unexpected(started.error());
  Frames frames;
  frames.kelvin = (*source)->info().scale.calibrated();
  for (;;) {
    auto frame = (*source)->next(std::chrono::seconds(1));
    if (!frame && frame.error().code == ErrorCode::disconnected) return frames;
    if (!frame) return tl::unexpected(frame.error());
    if (frame->status != FrameStatus::complete) continue;
    cv::Mat1f picture;
    if (frames.kelvin) {
      auto kelvin = to_kelvin(*frame);
      if (!kelvin) return fail(id, kelvin.error());
      // Single precision keeps a tenth of a millikelvin of what is left above freezing.
      cv::Mat1d(*kelvin - 273.15).convertTo(picture, CV_32F);
    } else {
      frame->counts.convertTo(picture, CV_32F);
    }
    frames.pictures.push_back(picture);
  }
}

bool moved(const RecordedNoise& noise) {
  return std::max(noise.correlation_x, noise.correlation_y) > moved_scene;
}

Json components_json(const ThreeDNoise& c) {
  return {{"tvh", json_number(c.tvh)}, {"tv", json_number(c.tv)}, {"th", json_number(c.th)}, {"t", json_number(c.t)},
          {"vh", json_number(c.vh)},   {"v", json_number(c.v)},   {"h", json_number(c.h)}};
}

Json noise_json(const RecordedNoise& noise, const std::vector<NoiseAcuity>& points, bool kelvin,
                const NoiseArguments& arguments) {
  Json list = Json::array();
  for (const auto& p : points) {
    list.push_back({{"contrast_over_noise", p.contrast_over_noise},
                    {"s75_pitch", json_number(p.real.s75_pitch)},
                    {"s75_white_pitch", json_number(p.white.s75_pitch)},
                    {"acuity_ratio", json_number(p.acuity_ratio)},
                    {"acuity_ratio_ci95", json_interval(p.ratio_ci95)},
                    {"template_noise_ratio", json_number(p.template_noise_ratio)},
                    {"predicted_acuity_ratio", json_number(p.predicted_ratio)},
                    {"pixel_share", json_number(p.pixel_share)},
                    {"row_share", json_number(p.row_share)},
                    {"column_share", json_number(p.column_share)},
                    {"correlated_share", json_number(p.correlated_share)}});
  }
  return {{"recording", arguments.recording},
          {"unit", kelvin ? "K" : "counts"},
          {"width", noise.usable.cols},
          {"height", noise.usable.rows},
          {"blocks", noise.blocks},
          {"block_frames", arguments.block_frames},
          {"usable_share", noise.usable_share},
          {"temporal_noise", json_number(noise.temporal_noise)},
          {"components", components_json(noise.components)},
          {"correlation_x", json_number(noise.correlation_x)},
          {"correlation_y", json_number(noise.correlation_y)},
          {"observer", arguments.observer},
          {"sensor", arguments.sensor},
          {"verdict", moved(noise) ? "scene_moved" : "ok"},
          {"points", list}};
}

void print_components(Console& console, const RecordedNoise& noise, bool kelvin) {
  const auto& c = noise.components;
  const std::string unit = kelvin ? "K" : "counts";
  console.text("temporal noise " + fixed(noise.temporal_noise, 4) + " " + unit + " over " +
               fixed(100 * noise.usable_share, 1) + " % of the pixels; neighbours correlate by " +
               fixed(noise.correlation_x, 3) + " in a row, " + fixed(noise.correlation_y, 3) + " in a column");
  console.table({"component", "sd [" + unit + "]"}, {{"pixels in time (tvh)", fixed(c.tvh, 4)},
                                                     {"rows in time (tv)", fixed(c.tv, 4)},
                                                     {"columns in time (th)", fixed(c.th, 4)},
                                                     {"frames in time (t)", fixed(c.t, 4)},
                                                     {"fixed pattern and scene (vh)", fixed(c.vh, 4)},
                                                     {"fixed rows (v)", fixed(c.v, 4)},
                                                     {"fixed columns (h)", fixed(c.h, 4)}});
}

void print_acuities(Console& console, const std::vector<NoiseAcuity>& points) {
  std::vector<TableRow> rows, why;
  for (const auto& p : points) {
    rows.push_back({fixed(p.contrast_over_noise, 1), fixed(p.real.s75_pitch, 3), fixed(p.white.s75_pitch, 3),
                    fixed(p.acuity_ratio, 3), range(p.ratio_ci95, 3), fixed(p.predicted_ratio, 3)});
    why.push_back({fixed(p.contrast_over_noise, 1), fixed(p.template_noise_ratio, 3), fixed(p.pixel_share, 3),
                   fixed(p.row_share, 3), fixed(p.column_share, 3), fixed(p.correlated_share, 3)});
  }
  console.text("");
  console.text("75 % sizes under this noise and under white noise of the same strength");
  console.table({"dT / noise", "S75 [pitch]", "S75 white", "acuity real / white", "95 %", "predicted from r"}, rows);
  console.text("");
  console.text("what moves the decision: r^2, the variance in the templates' differences over that of white noise");
  console.table({"dT / noise", "r", "pixels", "rows", "columns", "correlated"}, why);
}

int run_noise(Console& console, NoiseArguments arguments, const Program& program) {
  auto sensor = load_sensor(arguments.sensor);
  if (!sensor) return report_error(console, sensor.error());
  auto spec = load_observer(arguments.observer);
  if (!spec) return report_error(console, spec.error());
  auto frames = frames_of(arguments.recording);
  if (!frames) return report_error(console, frames.error());
  const auto count = static_cast<int>(frames->pictures.size());
  if (count < arguments.block_frames && count >= 2) {
    console.note("the recording holds " + std::to_string(count) + " frames: they are one block");
    arguments.block_frames = count;
  }
  auto noise = recorded_noise(frames->pictures, arguments.block_frames);
  if (!noise) return report_error(console, with_context(arguments.recording, noise.error()));
  if (moved(*noise)) {
    // Components and acuity would be those of the moving scene.
    console.note("neighbouring pixels change together: the scene or the camera moved, this is not the camera's noise");
    if (console.json()) {
      console.object(noise_json(*noise, {}, frames->kelvin, arguments));
    } else {
      print_components(console, *noise, frames->kelvin);
    }
    return exit_code(VerdictKind::inconclusive);
  }
  TemplateObserver observer(*spec, triangle_alternatives());
  arguments.study.seed = program.common.seed;
  arguments.study.stop = program.stop->token();
  const auto points = real_noise_study(*noise, *sensor, observer, arguments.study);
  if (!points) return report_error(console, points.error());
  if (console.json()) {
    console.object(noise_json(*noise, *points, frames->kelvin, arguments));
  } else {
    print_components(console, *noise, frames->kelvin);
    print_acuities(console, *points);
  }
  return 0;
}

}  // namespace

void add_noise_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "noise", "noise of a recording by direction, and the observer's acuity under it beside white noise");
  auto a = std::make_shared<NoiseArguments>();
  command->add_option("RECORDING", a->recording, "file.seq, or file.raw?width=W&height=H[&kelvin_per_count=K]")
      ->required();
  command->add_option("--sensor", a->sensor, "whose optics degrade the triangles")->capture_default_str();
  command->add_option("--observer", a->observer, "name or file")->capture_default_str();
  command->add_option("--block-frames", a->block_frames, "frames over which each pixel's mean is removed")
      ->check(whole_number(2, 100000))
      ->capture_default_str();
  command
      ->add_option("--contrast-over-noise", a->study.contrast_over_noise,
                   "contrasts in units of the temporal noise, separated by commas; default 1.6,3.3,8,28")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_in(0.05, 1e6));
  finish_command(*command, program, [a, &program](Console& console) { return run_noise(console, *a, program); });
}

}  // namespace todbench
