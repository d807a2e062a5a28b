// SPDX-License-Identifier: GPL-3.0-or-later
// A camera of eight bits with gain control through the GigE path, beside the same camera with its temperatures.
#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <filesystem>

#include "bench/devices/emulation.h"
#include "bench/plan/descriptions.h"
#include "bench/run/experiment.h"
#include "bench/scene_dependence/scene_dependence.h"
#include "bench/session/open_session.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"
#include "sim_devices/lab/gvsp_laboratory.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

Plan grey_plan() {
  Plan plan = *load_plan("demo");
  plan.fit.estimator = EstimatorChoice::weibull;  // not of the function of the twin, which takes longer than the rest
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9, 1.93};
  plan.target.phases = 6;
  plan.simulation.phases = 1;
  plan.simulation.accuracy = "draft";
  plan.simulation.tolerance_percent = 20;
  plan.measurement.registration_frames = 8;
  plan.measurement.contrast_frames = 8;
  plan.measurement.frame_timeout_ms = 20000;
  plan.measurement.max_rejected_share = 0.9;  // a busy machine loses frames, and the others say the same
  plan.limits = {};
  return plan;
}

/// The plan with an emulated Ax5, its instruments and these settings of the camera.
struct Ax5Bench {
  std::unique_ptr<Laboratory> laboratory;
  Plan plan;

  explicit Ax5Bench(Plan wanted, const std::map<std::string, std::string>& settings = {}) {
    EmulationArguments arguments = emulation_for(wanted);
    arguments.camera = "gige-ax5";
    auto started = start_laboratory(arguments);
    if (!started) return;
    laboratory = *std::move(started);
    plan = with_laboratory(std::move(wanted), *laboratory);
    for (const auto& [name, value] : settings) plan.camera.settings[name] = value;
  }
};

const std::map<std::string, std::string> eight_bits{{"PixelFormat", "Mono8"}, {"ImageAdjustMethod", "Linear"}};

TEST(GreyCamera, WithGainControlHasTheCurveOfTheSameCameraWithTemperatures) {
  const testing::TemporaryFolder folder;
  Result<ExperimentOutcome> in_kelvin = fail(ErrorCode::internal, "not run"), in_grey = in_kelvin;
  {
    const Ax5Bench bench(grey_plan());
    ASSERT_TRUE(bench.laboratory);
    in_kelvin = measure_plan(bench.plan, {.folder = folder.path() / "kelvin"}, {}, {});
  }
  ASSERT_TRUE(in_kelvin) << in_kelvin.error().message;
  {
    Ax5Bench bench(grey_plan(), eight_bits);
    ASSERT_TRUE(bench.laboratory);
    bench.plan.camera.contrast = ContrastUnit::grey_levels;
    in_grey = measure_plan(bench.plan, {.folder = folder.path() / "grey"}, {}, {});
  }
  ASSERT_TRUE(in_grey) << in_grey.error().message;
  ASSERT_FALSE(in_grey->ended_by) << in_grey->ended_by->message;
  ASSERT_EQ(in_grey->curve.points.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const TodPoint& kelvin = in_kelvin->curve.points[i];
    const TodPoint& grey = in_grey->curve.points[i];
    ASSERT_TRUE(kelvin.fit.threshold && grey.fit.threshold && kelvin.fit.ci95.low && kelvin.fit.ci95.high &&
                grey.fit.ci95.low && grey.fit.ci95.high);
    const auto half = [](const TodPoint& p) { return std::log(*p.fit.ci95.high / *p.fit.ci95.low) / 2; };
    EXPECT_LT(std::abs(std::log(*grey.fit.threshold / *kelvin.fit.threshold)),
              1.7 * std::hypot(half(grey), half(kelvin)))
        << grey.set_delta_t_k << " K: 1.7 of a 95 % half-width is a chance of 1 in 1200";
    EXPECT_NEAR(grey.delta_t_k, grey.set_delta_t_k, 0.01) << "that of the black body";
    EXPECT_GT(grey.delta_t_se_k, 0.0003 * grey.delta_t_k);
    EXPECT_LT(grey.delta_t_se_k, 0.1 * grey.delta_t_k);
  }
  EXPECT_TRUE(check_session(folder.path() / "grey")->files.foreign.empty()) << "the file is one of the session";
  const auto text = read_text_file(folder.path() / "grey" / "grey-levels.csv");
  ASSERT_TRUE(text);
  const auto table = parse_csv(*text, "grey-levels.csv");
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows.size(), 2u * 2 * 6) << "a row for every frame that was judged";
}

/// An emulated Ax5 whose field a hot bar comes into.
struct BarBench {
  std::shared_ptr<std::atomic<bool>> in = std::make_shared<std::atomic<bool>>(false);
  std::unique_ptr<Laboratory> laboratory;
  ExperimentHost operating;
  int moves = 0;

  BarBench() {
    LaboratoryOptions options;
    options.sensor = with_counts_of(CameraModel::ax5, load_sensor("sc2000").value());
    options.plan = full_plan(options.sensor, {}, {}, any_motion);
    options.accuracy = Accuracy::draft();
    options.plates = {load_plate("tcat-a").value()};
    GvspCameraConfig camera;
    camera.model = CameraModel::ax5;
    camera.serial = "TB0001";
    options.connect = [connect = connect_gvsp(camera), in = in](const SensorSpec& sensor, LaboratoryExposure exposure) {
      const int bar_counts = static_cast<int>(40 / sensor.kelvin_per_count);
      return connect(sensor, [exposure = std::move(exposure), in, bar_counts](std::uint64_t index) {
        cv::Mat1w counts = exposure(index);
        if (*in) counts(cv::Rect(2, 48, 16, 144)) += bar_counts;
        return counts;
      });
    };
    options.black_body.time_constant_s = 0.05;
    options.black_body.stable_dwell_s = 0.05;
    options.stage.speed_mm_per_s = 200;
    options.stage.settle_s = 0.02;
    options.stage.plate_change_s = 0.1;
    options.stage.mounting_change_s = 0.1;
    auto started = Laboratory::start(std::move(options));
    if (started) laboratory = *std::move(started);
    operating.ask_operator = [this](const OperatorRequest& request, const std::stop_token&) {
      for (const OperatorStep& step : request.steps) *in = std::get<MoveHotBar>(step).in;
      ++moves;
      return Result<OperatorAnswer>(OperatorAnswer::done);
    };
  }
};

TEST(GreyCamera, WithGainControlDependsOnAHotBarAndTheSameWithTemperaturesDoesNot) {
  BarBench bench;
  ASSERT_TRUE(bench.laboratory);
  Plan plan = grey_plan();
  plan.target.plates = {"tcat-a"};
  plan.target.delta_t_k = {16.9};
  plan = with_laboratory(plan, *bench.laboratory);
  const SceneDependenceOptions quick{.cycles = 3, .frames = 4, .settle_frames = 2};

  const auto linear = plan_scene_dependence(LoadedPlan::load(plan).value(), nullptr, 40, quick, bench.operating, {});
  for (const auto& [name, value] : eight_bits) plan.camera.settings[name] = value;
  plan.camera.contrast = ContrastUnit::grey_levels;
  const auto grey = plan_scene_dependence(LoadedPlan::load(plan).value(), nullptr, 40, quick, bench.operating, {});

  ASSERT_TRUE(linear) << linear.error().message;
  ASSERT_TRUE(grey) << grey.error().message;
  EXPECT_EQ(linear->verdict, SceneDependenceVerdict::independent);
  EXPECT_EQ(grey->verdict, SceneDependenceVerdict::depends);
  EXPECT_EQ(bench.moves, 2 * 7);
  // The range of the means grows from that of the triangles, 16.9 K and the noise of means of nine, to that of the bar.
  EXPECT_NEAR(grey->sizes.front().ratio, 17.0 / 40.1, 0.02);
}

TEST(GreyCamera, IsRefusedInKelvinAndWithoutLargeTriangles) {
  const testing::TemporaryFolder folder;
  Ax5Bench bench(grey_plan(), eight_bits);
  ASSERT_TRUE(bench.laboratory);
  const auto in_kelvin = measure_plan(bench.plan, {.folder = folder.path() / "kelvin"}, {}, {});
  ASSERT_FALSE(in_kelvin);
  EXPECT_EQ(in_kelvin.error().code, ErrorCode::calibration);

  bench.plan.camera.contrast = ContrastUnit::grey_levels;
  bench.plan.measurement.min_reference_px = 5.5;
  const auto too_small = measure_plan(bench.plan, {.folder = folder.path() / "small"}, {}, {});
  ASSERT_FALSE(too_small);
  EXPECT_EQ(too_small.error().code, ErrorCode::invalid_input);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "small")) << "nothing was begun";

  bench.plan.measurement.min_reference_px = 4;
  bench.plan.measures.noise = true;
  EXPECT_FALSE(validate(bench.plan)) << "grey levels are no kelvin";
}

}  // namespace
}  // namespace todbench
