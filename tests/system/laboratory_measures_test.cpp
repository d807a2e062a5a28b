// SPDX-License-Identifier: GPL-3.0-or-later
// Physical measures of whole sessions: `todbench measure` in an emulated laboratory of known truth.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>

#include "bench/devices/emulation.h"
#include "sim_devices/lab/genicam/picture_encoder.h"
#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

constexpr double ifov_mrad = 1.3085399449;  // of the sensor sc2000

/// A session of one presentation, and the measures that follow it.
class MeasuredLaboratories : public ::testing::Test {
 protected:
  /// Measures in a laboratory with these options of `emulate`; `camera`: keys of [camera].
  Ended measure(const EmulationArguments& arguments, const std::function<void(LaboratoryOptions&)>& change,
                const std::string& measures, const std::string& camera = "", const std::string& measurement = "") {
    auto options = laboratory_options(arguments);
    if (!options) return {-1, "", options.error().message};
    if (change) change(*options);
    const auto laboratory = Laboratory::start(*std::move(options));
    if (!laboratory) return {-1, "", laboratory.error().message};
    folder_.write("plan.toml",
                  "name = \"measures\"\n[camera]\nid = \"gige:127.0.0.1\"\nifov_mrad = 1.3085399449\n" + camera +
                      "[simulation]\naccuracy = \"draft\"\nphases = 2\nsensor = \"" + arguments.sensor +
                      "\"\n[fit]\nestimator = \"weibull\"\n[measurement]\nregistration_frames = 8\n"
                      "contrast_frames = 8\nframe_timeout_ms = 20000\nmax_rejected_share = 0.9\n" +
                      measurement +
                      "[target]\n"
                      "kind = \"scpi\"\nblack_body = \"" +
                      (*laboratory)->black_body_endpoint() + "\"\nstage = \"" + (*laboratory)->stage_endpoint() +
                      "\"\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\ndelta_t_k = [16.9]\n"
                      "phases = 1\n[measures]\n" +
                      measures);
    return todbench({"measure", "./plan.toml", "--out", "m", "--json"}, {.folder = folder_.path()});
  }
  static EmulationArguments with_plates(std::vector<std::string> plates) {
    return {.plates = std::move(plates), .black_body_port = 0, .stage_port = 0};
  }
  [[nodiscard]] Json record() const { return Json::parse(content_of(folder_.path() / "m" / "measures.json")); }
  [[nodiscard]] std::string log() const { return content_of(folder_.path() / "m" / "log.txt"); }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

/// The quantity of a side of measures.json; null if it is absent.
Json quantity(const Json& side, const std::string& name) {
  for (const Json& one : side.at("quantities")) {
    if (one.at("measure") == name) return one;
  }
  return {};
}

/// Half-widths of a result with three degrees of freedom: exceeded by chance in 0.1 % of the runs, two in 0.8 %.
constexpr double of_few_degrees = 4;

/// Passes if a truth lies within that many half-widths of the 95 % interval; two are four standard uncertainties.
::testing::AssertionResult holds(const Json& side, const std::string& name, double truth, double half_widths = 2) {
  const Json found = quantity(side, name);
  if (found.is_null() || found["value"].is_null())
    return ::testing::AssertionFailure() << name << " is absent: " << side.at("reasons");
  const double value = found["value"], half = 0.5 * (found["ci95"][1].get<double>() - found["ci95"][0].get<double>());
  if (std::abs(value - truth) <= half_widths * half) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << name << " is " << value << ", half-width " << half << ", truth " << truth;
}

TEST_F(MeasuredLaboratories, StateTheErrorOfTheAbsoluteScaleTheGeometryAndTheTimesOfTheCamera) {
  EmulationArguments arguments = with_plates({"tcat-a", "open"});
  arguments.latency_ms = 35;
  double scene_k = 0;
  const auto wrong_scale = [&](LaboratoryOptions& options) {
    options.stated_scale = 1.02;
    scene_k = options.sensor.scene_temperature_k;
  };

  const Ended ended = measure(arguments, wrong_scale,
                              "geometry = true\nabsolute = true\nabsolute_temperatures_k = [285, 295, 305]\n"
                              "absolute_frames = 12\ntiming = true\ntiming_frames = 60\nlatency = true\n"
                              "latency_runs = 4\n");

  ASSERT_TRUE(completed(ended));
  const Json side = record()["main"];
  EXPECT_TRUE(side["reasons"].empty()) << side["reasons"];
  // The scale is 2 % wrong about the temperature of the scene.
  EXPECT_TRUE(holds(side, "absolute_slope", 1.02, of_few_degrees));
  EXPECT_TRUE(holds(side, "absolute_offset", 0.02 * (295 - scene_k), of_few_degrees));
  const double worst_k = 0.02 * (285 - scene_k);
  EXPECT_TRUE(holds(side, "absolute_error", worst_k, of_few_degrees));
  EXPECT_TRUE(holds(side, "latency", 35, of_few_degrees));
  // The clock of the emulated camera advances by one frame an exposure.
  EXPECT_NEAR(quantity(side, "frame_rate")["value"].get<double>(), 50, 1e-9);
  EXPECT_EQ(quantity(side, "lost_frames")["unit"], "1");
  EXPECT_TRUE(holds(side, "ifov_x", ifov_mrad));
  EXPECT_TRUE(holds(side, "ifov_y", ifov_mrad));
  EXPECT_TRUE(holds(side, "aspect_ratio", 1));
  const auto field_deg = [](double pixels) {
    return 2 * std::atan(0.5e-3 * pixels * ifov_mrad) * 180 / std::numbers::pi;
  };
  EXPECT_TRUE(holds(side, "field_of_view_x", field_deg(320)));
  EXPECT_TRUE(holds(side, "field_of_view_y", field_deg(240)));
  EXPECT_TRUE(holds(side, "distortion", 0));
}

TEST_F(MeasuredLaboratories, StateTheHaloOfTheCameraBeforeAPlateThatWarmsUp) {
  const std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  EmulationArguments arguments = with_plates({"tcat-a", "apertures"});
  arguments.sensor = folder().write("halo.toml", sensor + "\nhalo_share = 0.05\nhalo_sigma_pitch = 10\n").string();
  // The plate takes a twentieth of the contrast: as much as the halo.
  const auto warm_plate = [](LaboratoryOptions& options) { options.black_body.plate_coupling = 0.05; };

  const Ended ended = measure(arguments, warm_plate, "source_size = true\nsource_size_frames = 48\n");

  ASSERT_TRUE(completed(ended));
  const Json measures = record();
  const Json &side = measures["main"], &twin = measures["twin"];
  EXPECT_TRUE(side["reasons"].empty()) << side["reasons"];
  const double truth = quantity(twin, "source_size_loss_model")["value"];
  EXPECT_GT(truth, 0.04);
  EXPECT_TRUE(holds(side, "source_size_loss", truth));
  EXPECT_TRUE(side["source_size"]["consistent"].get<bool>()) << side["source_size"]["chi2"];
  // Both see the same plate with noise of 0.0002; what remains of the halo beyond the reference is in both.
  const double apart = quantity(side, "transfer_slope_extended")["value"].get<double>() -
                       quantity(twin, "transfer_slope_extended")["value"].get<double>();
  EXPECT_NEAR(apart, 0, 0.002);
  // Without the temperature of the plate the spots would show 0.05 more.
  for (std::size_t i = 0; i < side["source_size"]["points"].size(); ++i) {
    const Json &seen = side["source_size"]["points"][i], &simulated = twin["source_size"]["points"][i];
    EXPECT_NEAR(seen["ratio"]["value"].get<double>(), simulated["ratio"]["value"].get<double>(), 0.006) << seen;
  }
}

TEST_F(MeasuredLaboratories, StateTheMrtdThatTheSensorHasWithoutFrames) {
  const Ended ended = measure(with_plates({"tcat-a", "mrtd"}), {},
                              "mrtd = true\nmrtd_delta_t_k = [0.008, 0.016, 0.032, 0.064]\nmrtd_frames = 12\n"
                              "mrtd_set_ups = 5\nmrtd_frequency_per_pitch = 0.3\n");
  const Ended virtual_bars = todbench(
      {"mrtd", "--sensor", "sc2000", "--accuracy", "draft", "--draws", "600", "--of-nyquist", "0.6", "--json"});

  ASSERT_TRUE(completed(ended));
  ASSERT_EQ(virtual_bars.code, 0) << virtual_bars.err;
  const Json side = record()["main"];
  EXPECT_TRUE(side["reasons"].empty()) << side["reasons"];
  const Json axes = one_object(virtual_bars)["axes"];
  for (const auto& [name, axis] : {std::pair("mrtd_x", "horizontal"), std::pair("mrtd_y", "vertical")}) {
    const Json found = quantity(side, name), truth = axes[axis][0];
    ASSERT_TRUE(found.is_object() && found["value"].is_number()) << name;
    const auto half = [](const Json& interval) {
      return 0.5 * std::log(interval[1].get<double>() / interval[0].get<double>());
    };
    const double apart = std::log(found["value"].get<double>() / truth["threshold_k"].get<double>());
    // Two half-widths are four standard uncertainties, of both.
    EXPECT_LT(std::abs(apart), 2 * std::hypot(half(found["ci95"]), half(truth["threshold_ci95_k"]))) << name;
    EXPECT_LT(half(found["ci95"]), 0.6) << name;
  }
}

TEST_F(MeasuredLaboratories, BeginWhenTheCameraIsWarmAndSayHowWarmItWas) {
  EmulationArguments arguments = with_plates({"tcat-a"});
  // 6 K/min exp(-t / 2 s) is below 0.6 K/min from 4.6 s on.
  arguments.drift_k_per_min = 6, arguments.drift_time_constant_s = 2;

  const Ended ended = measure(arguments, {}, "timing = true\ntiming_frames = 20\n",
                              "[camera.warm_up]\ndrift_k_per_min = 0.6\nwindow_s = 1\ntimeout_s = 60\n");

  ASSERT_TRUE(completed(ended));
  EXPECT_THAT(log(), HasSubstr("the camera warmed up for "));
  EXPECT_THAT(log(), HasSubstr("below 0.6 K/min"));
  EXPECT_THAT(content_of(folder().path() / "m" / "report.html"), HasSubstr("the camera warmed up for "));
}

TEST_F(MeasuredLaboratories, RefuseACameraThatNeverWarmsUp) {
  EmulationArguments arguments = with_plates({"tcat-a"});
  arguments.drift_k_per_min = 6;

  const Ended ended = measure(arguments, {}, "timing = true\ntiming_frames = 20\n",
                              "[camera.warm_up]\ndrift_k_per_min = 0.6\nwindow_s = 1\ntimeout_s = 3\n");

  EXPECT_EQ(ended.code, 6) << ended.err;
  EXPECT_THAT(lines_of(ended.err).back(), HasSubstr("the warm-up did not end within 3 s: it drifts by "));
}

/// Counts as a gain control sends them: its map from counts to levels approaches that of the present picture with a
/// time constant, as a filter of the map does. The range of the picture becomes 26 to 230, at most four levels a count.
class FilteredGain {
 public:
  explicit FilteredGain(double part_of_a_frame) : part_(part_of_a_frame) {}
  cv::Mat1w operator()(const cv::Mat1w& counts, double delta_t_k) {
    const CountRange range = range_of_means(counts);
    const double gain = std::min(4.0, 204 / (range.high - range.low));
    const double offset = 128 - 0.5 * gain * (range.low + range.high);
    const double part = started_ ? part_ : 1;
    gain_ += part * (gain - gain_), offset_ += part * (offset - offset_), started_ = true;
    const std::scoped_lock lock(mutex_);
    // Between two contrasts the black body passes values that only round to the whole kelvin.
    if (std::abs(delta_t_k - std::round(delta_t_k)) < 0.02) settled_[std::round(delta_t_k)] = gain;
    cv::Mat1w levels(counts.size());
    std::transform(counts.begin(), counts.end(), levels.begin(), [&](std::uint16_t count) {
      return static_cast<std::uint16_t>(std::clamp(std::nearbyint(gain_ * count + offset_), 0.0, 255.0));
    });
    return levels;
  }
  /// Levels a count of the last picture at this contrast, in whole kelvin.
  [[nodiscard]] double settled_at(double delta_t_k) const {
    const std::scoped_lock lock(mutex_);
    const auto found = settled_.find(delta_t_k);
    return found == settled_.end() ? std::nan("") : found->second;
  }

 private:
  double part_, gain_ = 0, offset_ = 0;
  bool started_ = false;
  mutable std::mutex mutex_;
  std::map<double, double> settled_;
};

TEST_F(MeasuredLaboratories, StateHowTheGainOfTheCameraFollowsTheContrast) {
  constexpr double frame_ms = 20, time_constant_ms = 60;
  const auto gain = std::make_shared<FilteredGain>(1 - std::exp(-frame_ms / time_constant_ms));
  const auto controlled = [&](LaboratoryOptions& options) {
    options.sent_counts = [gain](const cv::Mat1w& counts, const PlateScene& scene) {
      return (*gain)(counts, scene.delta_t_k);
    };
  };

  const Ended ended = measure(with_plates({"tcat-a"}), controlled,
                              "gain_control = true\nresponse_settling_ms = 30\nresponse_steps = 6\n"
                              "transfer_steps_k = [-1, 2, 4]\n",
                              "contrast = \"grey-levels\"\n", "frames_after_change = 20\n");

  ASSERT_TRUE(completed(ended));
  const Json side = record()["main"];
  EXPECT_TRUE(side["reasons"].empty()) << side["reasons"];
  EXPECT_TRUE(holds(side, "gain_settling_time", time_constant_ms)) << side["gain_control"]["settling"];
  // The picture of a contrast has 8 frames of noise; the range that the gain follows has that of each frame, 3 %.
  const double ratio = gain->settled_at(4) / gain->settled_at(-1);
  EXPECT_LT(ratio, 0.4);
  EXPECT_NEAR(quantity(side, "gain_ratio")["value"].get<double>(), ratio, 0.06 * ratio);
  EXPECT_EQ(side["gain_control"]["unit"], "count");
  EXPECT_EQ(side["gain_control"]["levels"].size(), 3u);
  EXPECT_THAT(content_of(folder().path() / "m" / "report.html"), HasSubstr("Levels of the automatic gain"));
}

TEST_F(MeasuredLaboratories, SayThatACameraWithTemperaturesDoesNotControlItsGain) {
  const Ended ended = measure(with_plates({"tcat-a"}), {},
                              "gain_control = true\nresponse_settling_ms = 30\nresponse_steps = 4\n"
                              "response_frames = 8\ntransfer_steps_k = [-2, 2, 4]\n");

  ASSERT_TRUE(completed(ended));
  const Json side = record()["main"];
  EXPECT_TRUE(quantity(side, "gain_settling_time").is_null());
  EXPECT_THAT(side["reasons"].dump(), HasSubstr("the camera does not control its gain"));
  EXPECT_TRUE(holds(side, "gain_ratio", 1));
}

}  // namespace
}  // namespace todbench::testing
