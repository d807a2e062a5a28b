// SPDX-License-Identifier: GPL-3.0-or-later
// todbench render, todbench mtf
#include <fmt/format.h>
#include <cmath>
#include <filesystem>
#include <memory>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/plan/descriptions.h"
#include "bench/text/files.h"
#include "sim_devices/sensor/effect_detector.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

struct RenderArguments {
  std::string sensor, apex = "up", accuracy = "normal", noise = "off", tiff;
  double size_pitch = 0, x_pitch = 0, y_pitch = 0, delta_t_k = 1;
  int microscan = 0, window = 9;
};

struct MtfArguments {
  std::string sensor;
  std::vector<double> frequency_per_pitch;
};

Json rows_of(const cv::Mat1d& values) {
  Json rows = Json::array();
  for (int j = 0; j < values.rows; ++j)
    rows.push_back(json_numbers({values[j], static_cast<std::size_t>(values.cols)}));
  return rows;
}

/// The triangle in pitches of each axis.
Polygon shape_of(const SensorSpec& spec, const RenderArguments& a) {
  return placed(on_detectors(triangle(a.size_pitch, *apex_from(a.apex)), spec), 1, {a.x_pitch, a.y_pitch});
}

/// Renders a window of the degraded triangle for an infinite plane at 1 K, with a bound on its numerical error.
ImageChain::InfinitePlane degraded(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy,
                                   const RenderArguments& a) {
  const double step = 1.0 / spec.samples_per_pitch();
  const int half_window = a.window / 2;
  const double first = -step * half_window;
  const Polygon shape = shape_of(spec, a);
  auto image = ImageChain(spec, plan, accuracy).infinite_plane(shape, {first, first}, step, {a.window, a.window});
  // Error of the band's wavelengths: the change for twice as many nodes.
  Accuracy finer = accuracy;
  finer.wavelengths = std::min(64, 2 * accuracy.wavelengths);
  const auto check = ImageChain(spec, plan, finer).infinite_plane(shape, {first, first}, step, {a.window, a.window});
  image.max_error_estimate += cv::norm(image.values, check.values, cv::NORM_INF);
  return image;
}

/// Renders the same window as the simulated camera shows it: noise, defects, display and counts. A margin covers the
/// reach of display and dead detectors.
cv::Mat1d as_exposed(SensorSpec spec, const SensorPlan& plan, const Accuracy& accuracy, const RenderArguments& a,
                     std::uint64_t seed) {
  constexpr int margin = 8;  // detectors; the display reaches eight samples
  const int n = spec.samples_per_pitch();
  spec.width = spec.height = (a.window + n - 1) / n + 2 * margin;
  const SensorModel camera(spec, plan, accuracy, seed);
  const int before = (camera.size().width - a.window) / 2;
  const int centre = before + a.window / 2;
  const double step = 1.0 / n;
  const double first = -step * centre;
  const Polygon shape = shape_of(spec, a);
  cv::Mat1f signal;
  ImageChain(spec, plan, accuracy)
      .infinite_plane(shape, {first, first}, step, camera.size())
      .values.convertTo(signal, CV_32F);
  const cv::Mat1f shown = camera.picture(signal, a.delta_t_k, spec.scene_temperature_k, 0);
  cv::Mat1d window;
  shown(cv::Rect(before, before, a.window, a.window)).convertTo(window, CV_64F);
  return window;
}

/// Encodes in memory, so that the file is complete or absent.
Result<void> write_tiff(const std::string& file, const cv::Mat1f& kelvin) {
  const auto folder = std::filesystem::path(file).parent_path();
  if (std::error_code problem; !folder.empty() && !std::filesystem::is_directory(folder, problem))
    return fail(ErrorCode::invalid_input, "--tiff " + file + ": " + folder.string() + " is not a folder");
  TODBENCH_TRY(const auto encoded, tiff_of(kelvin));
  return write_file_atomically(file, encoded);
}

int run_render(Console& console, const RenderArguments& a, std::uint64_t seed) {
  auto spec = load_sensor(a.sensor);
  if (!spec) return report_error(console, spec.error());
  if (a.microscan > 0) spec->microscan = a.microscan;
  if (auto valid = validate(*spec); !valid) return report_error(console, valid.error());
  auto accuracy = Accuracy::named(a.accuracy);
  if (!accuracy) return report_error(console, accuracy.error());
  const SensorPlan plan = full_plan(*spec, {}, {});
  auto image = degraded(*spec, plan, *accuracy, a);
  image.values *= a.delta_t_k;
  image.max_error_estimate *= std::abs(a.delta_t_k);
  if (a.noise == "on") image.values = as_exposed(*spec, plan, *accuracy, a, seed);
  if (!a.tiff.empty()) {
    cv::Mat1f single;
    image.values.convertTo(single, CV_32F);
    if (auto written = write_tiff(a.tiff, single); !written) return report_error(console, written.error());
  }
  const cv::Point2d pitch_mrad = sample_mrad(*spec);
  if (console.json()) {
    Json object{{"values", rows_of(image.values)},
                {"pitch_mrad", pitch_mrad.x},
                {"max_error_estimate", json_number(image.max_error_estimate)}};
    if (spec->pitch_aspect() != 1) object["pitch_y_mrad"] = pitch_mrad.y;
    console.object(object);
    return 0;
  }
  for (int j = 0; j < image.values.rows; ++j) {
    std::string line;
    for (int i = 0; i < image.values.cols; ++i) {
      line += fmt::format("{}{:10.6f}", i == 0 ? "" : " ", image.values(j, i));
    }
    console.text(line);
  }
  const std::string along_y =
      spec->pitch_aspect() != 1 ? fmt::format(" along x, {:.6f} mrad along y", pitch_mrad.y) : "";
  console.text(fmt::format("contrast in K; sample spacing {:.6f} mrad{}; numerical error at most about {:.1e} K",
                           pitch_mrad.x, along_y, image.max_error_estimate));
  return 0;
}

int run_mtf(Console& console, const MtfArguments& a) {
  auto spec = load_sensor(a.sensor);
  if (!spec) return report_error(console, spec.error());
  const SensorPlan plan = full_plan(*spec, {}, {});
  const OpticsMtf optics(*spec, plan, 16);
  Json frequency = Json::array(), per_mrad = Json::array(), optical = Json::array();
  Json detector[2] = {Json::array(), Json::array()}, system[2] = {Json::array(), Json::array()};
  std::vector<TableRow> rows;
  for (const double f : a.frequency_per_pitch) {
    const double o = optics(f);
    frequency.push_back(f);
    per_mrad.push_back(f / spec->ifov_mrad());
    optical.push_back(o);
    rows.push_back({fixed(f, 4), fixed(f / spec->ifov_mrad(), 4), fixed(o, 6)});
    for (const PitchAxis axis : {PitchAxis::x, PitchAxis::y}) {
      // One frequency in space for both axes, in cycles per pitch along x.
      const double along_x = axis == PitchAxis::x ? f : 0,
                   along_y = axis == PitchAxis::y ? f * spec->pitch_aspect() : 0;
      const double d = detector_mtf(along_x, along_y, spec->detector_pitch_ratio(PitchAxis::x),
                                    spec->detector_pitch_ratio(PitchAxis::y));
      detector[static_cast<int>(axis)].push_back(d);
      system[static_cast<int>(axis)].push_back(o * d);
      if (axis == PitchAxis::x || !spec->square_detector())
        rows.back().insert(rows.back().end(), {fixed(d, 6), fixed(o * d, 6)});
    }
  }
  if (console.json()) {
    Json json{{"frequency_per_pitch", frequency},
              {"frequency_per_mrad", per_mrad},
              {"optics", optical},
              {"detector", detector[0]},
              {"system", system[0]}};
    if (!spec->square_detector()) {
      json["detector_y"] = detector[1];
      json["system_y"] = system[1];
    }
    console.object(json);
  } else if (spec->square_detector()) {
    console.table({"f [1/pitch]", "f [1/mrad]", "MTF optics", "MTF detector", "MTF system"}, rows);
  } else {
    console.table(
        {"f [1/pitch]", "f [1/mrad]", "MTF optics", "MTF detector x", "MTF system x", "MTF detector y", "MTF system y"},
        rows);
  }
  return 0;
}

}  // namespace

void add_render_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("render", "renders the degraded image of one triangle, as numbers or TIFF");
  auto a = std::make_shared<RenderArguments>();
  command->add_option("--sensor", a->sensor, "sensor: name or file")->required();
  command->add_option("--size-pitch", a->size_pitch, "square root of the area of the triangle, in detector pitches")
      ->check(number_in(0.01, 500))
      ->required();
  command->add_option("--apex", a->apex, "direction of the apex: up, right, down or left")
      ->check(CLI::IsMember({"up", "right", "down", "left"}))
      ->capture_default_str();
  command
      ->add_option("--x-pitch", a->x_pitch,
                   "position of the centroid to the right of the middle sample, in detector pitches")
      ->check(number_in(-1000, 1000));
  command->add_option("--y-pitch", a->y_pitch, "position of the centroid below the middle sample, in detector pitches")
      ->check(number_in(-1000, 1000));
  command->add_option("--delta-t-k", a->delta_t_k, "contrast of the triangle in K")
      ->check(number_in(-5000, 5000, "k"))
      ->capture_default_str();
  command->add_option("--microscan", a->microscan, "samples per detector pitch and axis; default: those of the sensor")
      ->check(whole_number(1, 4));
  command->add_option("--window", a->window, "samples on each side of the rendered window")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command->add_option("--accuracy", a->accuracy, "numerical accuracy: draft, normal or reference")
      ->check(CLI::IsMember({"draft", "normal", "reference"}))
      ->capture_default_str();
  command
      ->add_option("--noise", a->noise, "off or on; on adds noise, defective pixels, display and counts of the camera")
      ->check(CLI::IsMember({"off", "on"}))
      ->capture_default_str();
  command->add_option("--tiff", a->tiff, "writes the image to this file, a 32-bit floating-point TIFF in K");
  finish_command(*command, program,
                 [a, &program](Console& console) { return run_render(console, *a, program.common.seed); });
}

void add_mtf_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("mtf", "tabulates the MTF of optics, detector and whole sensor along x");
  auto a = std::make_shared<MtfArguments>();
  command->add_option("--sensor", a->sensor, "sensor: name or file")->required();
  command
      ->add_option("--frequency-per-pitch", a->frequency_per_pitch,
                   "spatial frequencies in cycles per detector pitch, separated by commas")
      ->required()
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_in(0, 1e6));
  finish_command(*command, program, [a](Console& console) { return run_mtf(console, *a); });
}

}  // namespace todbench
