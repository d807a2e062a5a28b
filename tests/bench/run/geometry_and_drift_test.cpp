// SPDX-License-Identifier: GPL-3.0-or-later
// IFOV and distortion, and drift, that a plan asks for: of cameras where they are known, and in a session.
#include "bench/run/physical_measures.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "acquisition/base/rng.h"
#include "bench/plan/descriptions.h"
#include "bench/report/report.h"
#include "bench/run/experiment.h"
#include "bench/run/report_data.h"
#include "bench/session/measures_record.h"
#include "bench/session/open_session.h"
#include "tests/bench/run/measures_plan.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::plan_of_one;
using testing::TemporaryFolder;

CameraMeasuresOptions drift_options(const SensorSpec& sensor, const TargetPlate& plate, double drift_s) {
  CameraMeasuresOptions options;
  options.drift_s = drift_s;
  options.transfer_steps_k = {16.9};
  options.measurement.ifov_mrad = sensor.ifov_mrad();
  options.measurement.distance_m = 2;
  options.measurement.plates = {plate};
  options.measurement.registration_frames = 4;
  return options;
}

TEST(PhysicalMeasures, FindTheIfovOfTheSensorAndJudgeItWithTheDistance) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::geometry);
  const double ifov_mrad = plan.camera.ifov_mrad;
  BudgetRow distance{.name = "distance", .value = 0.002, .unit = "m"};
  plan.uncertainty.rows = {distance};
  plan.limits.measures = {{"ifov_x", 0.98 * ifov_mrad, 1.02 * ifov_mrad},
                          {"ifov_y", 1.01 * ifov_mrad, std::nullopt},
                          {"distortion", std::nullopt, 3}};

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures && session->measures->main && session->measures->twin);
  EXPECT_THAT(session->measures->main->reasons, ::testing::IsEmpty());
  for (const char* name : {"ifov_x", "ifov_y"}) {
    const auto* line = line_of(session->measures->main, name);
    ASSERT_NE(line, nullptr);
    // Two half-widths are four standard uncertainties.
    const double half = 0.5 * (line->ci95.high.value() - line->ci95.low.value());
    EXPECT_NEAR(line->value.value(), ifov_mrad, 2 * half);
    EXPECT_LT(half, 0.003 * ifov_mrad);
    ASSERT_TRUE(line->expanded);
    // 2 mm of 2 m.
    EXPECT_NEAR(line->expanded->high.value() - line->value.value(), std::hypot(1.96e-3 * line->value.value(), half),
                1e-5);
    const auto* twin = line_of(session->measures->twin, name);
    ASSERT_NE(twin, nullptr);
    EXPECT_FALSE(twin->expanded);
  }
  EXPECT_EQ(line_of(session->measures->twin, "ifov_model")->value, ifov_mrad);
  const auto* distortion = line_of(session->measures->main, "distortion");
  ASSERT_NE(distortion, nullptr);
  EXPECT_LT(distortion->ci95.low.value(), 0);
  EXPECT_GT(distortion->ci95.high.value(), 0);
  ASSERT_TRUE(session->measures->main->geometry);
  EXPECT_GE(session->measures->main->geometry->geometry.places.size(), 12u);
  const auto decided = [&](DemandKind kind) {
    for (const Demand& demand : outcome->verdict.demands)
      if (demand.kind == kind) return demand;
    return Demand{};
  };
  EXPECT_EQ(decided(DemandKind{"ifov_x_at_least"}).decision, VerdictKind::pass);
  EXPECT_EQ(decided(DemandKind{"ifov_x_at_most"}).decision, VerdictKind::pass);
  EXPECT_EQ(decided(DemandKind{"ifov_y_at_least"}).decision, VerdictKind::fail);
  ASSERT_TRUE(decided(DemandKind{"ifov_x_at_most"}).statistical);
  EXPECT_NEAR(decided(DemandKind{"ifov_x_at_most"}).interval.high.value(),
              line_of(session->measures->main, "ifov_x")->expanded->high.value(), 1e-9);
  EXPECT_EQ(decided(DemandKind{"distortion"}).decision, VerdictKind::pass);
  EXPECT_EQ(decided(DemandKind{"distortion"}).interval.low, 0);
  EXPECT_THAT(render_report(*report_data(*session, "session")), HasSubstr("geometry-main"));
}

TEST(PhysicalMeasures, FindTheDistortionOfTheSensorAndOfItsTwin) {
  const TemporaryFolder folder;
  const std::string text = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  const std::string sensor = folder.write("barrel.toml", text + "\ndistortion_percent = -3\n").string();
  Plan plan = plan_of_one(&MeasuresPlan::geometry);
  plan.camera.id = "sim:" + sensor;
  plan.simulation.sensor = sensor;

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures);
  for (const auto* side : {&session->measures->main, &session->measures->twin}) {
    const auto* line = line_of(*side, "distortion");
    ASSERT_NE(line, nullptr);
    const double half = 0.5 * (line->ci95.high.value() - line->ci95.low.value());
    // Two half-widths are four standard uncertainties.
    EXPECT_NEAR(line->value.value(), -3, 2 * half);
    EXPECT_LT(half, 1);
    const auto* residual = line_of(*side, "geometry_residual");
    ASSERT_NE(residual, nullptr);
    EXPECT_LT(residual->value.value(), 0.02);
  }
  EXPECT_EQ(line_of(session->measures->twin, "distortion_model")->value, -3);
}

/// Field of view along the rows in degrees, by bisection for the ray that the lens shows at the border.
double field_of_view_deg(const SensorSpec& sensor) {
  const double half = 0.5 * sensor.width, corner = 0.5 * std::hypot(sensor.width, sensor.height);
  double low = 0, high = 2 * half;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.5 * (low + high), square = std::pow(r / corner, 2);
    const double seen = r * (1 + 0.01 * square * (sensor.distortion_percent + square * sensor.distortion_r4_percent));
    (seen < half ? low : high) = r;
  }
  return 2 * std::atan(low * 1e-3 * sensor.ifov_mrad()) * 180 / std::numbers::pi;
}

TEST(PhysicalMeasures, HoldTheDistortionOfTheSensorInTheirInterval) {
  constexpr std::uint64_t seeds = 20;
  int within = 0, field_within = 0, square = 0;
  double half = 0, error = 0;
  const TargetPlate plate = *load_plate("tcat-a");
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SensorSpec sensor = *load_sensor("sc2000");
    sensor.distortion_percent = seed % 2 == 0 ? 4 : -4;
    const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), seed);
    OpenedBench bench = simulated_bench(model, {plate}, 2, {});
    CameraMeasuresOptions options = drift_options(sensor, plate, 0);
    options.drift_s.reset();
    options.geometry = true;
    const auto measures = measure_camera(*bench.camera, *bench.target, options, *bench.host, {});
    ASSERT_TRUE(measures) << measures.error().message;
    ASSERT_TRUE(measures->geometry);
    const Estimate& found = measures->geometry->geometry.distortion_percent;
    within += found.low <= sensor.distortion_percent && sensor.distortion_percent <= found.high ? 1 : 0;
    const GeometryMeasure& geometry = *measures->geometry;
    const Estimate field = geometry.field_of_view_deg(EdgeAxis::x), aspect = geometry.aspect_ratio();
    const double true_field = field_of_view_deg(sensor);
    field_within += field.low <= true_field && true_field <= field.high ? 1 : 0;
    square += aspect.low <= 1 && 1 <= aspect.high ? 1 : 0;
    EXPECT_NEAR(field.value, true_field, 0.02 * true_field);
    half += 0.5 * (found.high - found.low) / seeds;
    error += (found.value - sensor.distortion_percent) / seeds;
  }
  RecordProperty("half_width_percent", std::to_string(half));
  RecordProperty("mean_error_percent", std::to_string(error));
  // 20 seeds at 95 %: fewer than 16 come by chance once in 390.
  EXPECT_GE(within, 16) << half << ' ' << error;
  EXPECT_GE(field_within, 16);
  EXPECT_GE(square, 16);
  EXPECT_LT(half, 1.5);
}

TEST(PhysicalMeasures, HoldTheFieldOfViewOfALensWithATermThatThePlateDoesNotShow) {
  const TargetPlate plate = *load_plate("tcat-a");
  for (const auto& [third, fifth] : {std::pair(-2.5, 0.7), {-2.5, -0.7}, {4.0, -1.5}}) {
    SensorSpec sensor = *load_sensor("sc2000");
    sensor.distortion_percent = third, sensor.distortion_r4_percent = fifth;
    const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
    OpenedBench bench = simulated_bench(model, {plate}, 2, {});
    CameraMeasuresOptions options = drift_options(sensor, plate, 0);
    options.drift_s.reset();
    options.geometry = true;

    const auto measures = measure_camera(*bench.camera, *bench.target, options, *bench.host, {});

    ASSERT_TRUE(measures && measures->geometry);
    const Estimate field = measures->geometry->field_of_view_deg(EdgeAxis::x);
    const double truth = field_of_view_deg(sensor);
    EXPECT_LE(field.low, truth) << third << ' ' << fifth;
    EXPECT_GE(field.high, truth) << third << ' ' << fifth;
  }
}

TEST(PhysicalMeasures, HoldTheLargestOfSeveralEqualAbsoluteErrors) {
  constexpr int seeds = 400, levels = 5;
  int within = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const RandomStream random(static_cast<std::uint64_t>(seed), "test.absolute");
    AbsoluteMeasure measure{.plate = "open", .frames = 8, .degrees_of_freedom = levels, .slope = {1, 1, 1}};
    double squares = 0;
    for (std::uint64_t i = 0; i < levels; ++i) {
      const double set_k = 285 + 5.0 * static_cast<double>(i);
      const double up = 0.004 * random.normal(2 * i), down = 0.004 * random.normal(2 * i + 1);
      measure.levels.push_back({.set_k = set_k,
                                .said_k = set_k,
                                .expected_k = set_k,
                                .seen_k = set_k + 0.5 * (up + down),
                                .difference_k = down - up});
      squares += (down - up) * (down - up);
    }
    measure.repeatability_k = std::sqrt(0.5 * squares / levels);
    measure.u_k = measure.repeatability_k / std::sqrt(2.0);
    CameraMeasures measures;
    measures.absolute = measure;

    const MeasureLines lines = measure_lines(measures);

    const auto* error = line_of(lines, "absolute_error");
    ASSERT_NE(error, nullptr);
    within += error->ci95.low.value() <= 0 && 0 <= error->ci95.high.value() ? 1 : 0;
  }
  // 95 % of 400, standard error 4.4. The interval of one temperature holds the largest error in 82 %.
  EXPECT_GE(within, 363);
}

TEST(PhysicalMeasures, FindNoDriftOfASensorThatHasNoneNorOfItsTwin) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::drift);
  plan.measures.drift_s = 4;

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures);
  for (const auto* side : {&session->measures->main, &session->measures->twin}) {
    ASSERT_TRUE(*side);
    EXPECT_THAT((*side)->reasons, ::testing::IsEmpty());
    ASSERT_TRUE((*side)->drift);
    // 200 frames of its own clock, however long they took.
    EXPECT_NEAR((*side)->drift->law.time_s.back() - (*side)->drift->law.time_s.front(), 3.8, 0.1);
    for (const char* name : {"drift_rate", "drift_pattern_rate"}) {
      const auto* line = line_of(*side, name);
      ASSERT_NE(line, nullptr);
      const double half = 0.5 * (line->ci95.high.value() - line->ci95.low.value());
      // Two half-widths are four standard uncertainties.
      EXPECT_NEAR(line->value.value(), 0, 2 * half);
      EXPECT_LT(half, 0.1);
    }
  }
}

/// A camera that drifts after each correction, with a clock of its own: 20 frames a second. It takes commands, or
/// corrects itself and tells of it.
class DriftingCamera : public FrameSource {
 public:
  DriftingCamera(FrameSource& camera, bool commanded) : camera_(camera), commanded_(commanded) {
    pattern_ = cv::Mat1f(camera.info().height, camera.info().width);
    std::vector<float> draws(pattern_.total());
    RandomStream(5, "test.drifting").fill_normal(draws);
    std::copy(draws.begin(), draws.end(), pattern_.begin());
  }
  static constexpr double level_k_per_s = 0.02, pattern_k_per_s = 0.004, frame_s = 0.05;
  bool stands_still = false;  ///< the time since the correction that it tells

  const SourceInfo& info() const override { return camera_.info(); }
  Result<void> start() override { return camera_.start(); }
  Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = camera_.next(timeout);
    if (!frame) return frame;
    constexpr std::int64_t own_every = 150;
    if (!commanded_ && ++taken_ % own_every == 0) corrected_at_ = taken_;
    if (commanded_) ++taken_;
    const double since_s = stands_still ? 1 : frame_s * static_cast<double>(taken_ - corrected_at_);
    frame->host_time_ns = start_ns_ + static_cast<std::int64_t>(1e9 * frame_s * static_cast<double>(taken_));
    frame->device_time_ns = 0;  // no clock of its own
    frame->correction = CorrectionState::idle;
    frame->since_correction_s = since_s;
    const double per_count = *info().scale.kelvin_per_count(1000);
    cv::Mat1d counts;
    frame->counts.convertTo(counts, CV_64F);
    cv::Mat1d pattern;
    pattern_.convertTo(pattern, CV_64F, pattern_k_per_s * since_s / per_count, level_k_per_s * since_s / per_count);
    cv::Mat1w drifted;
    cv::Mat1d(counts + pattern).convertTo(drifted, CV_16U);
    frame->counts = drifted;
    return frame;
  }
  void stop() override { camera_.stop(); }
  Result<std::string> get(const std::string& feature) override { return camera_.get(feature); }
  Result<void> set(const std::string& feature, const std::string& value) override {
    return camera_.set(feature, value);
  }
  Result<void> correct_nonuniformity() override {
    if (!commanded_) return fail(ErrorCode::invalid_input, "no such command");
    corrected_at_ = taken_;
    return {};
  }

 private:
  FrameSource& camera_;
  bool commanded_;
  cv::Mat1f pattern_;
  std::int64_t taken_ = 0, corrected_at_ = 0;
  /// Ahead of the host's clock, so that no frame is older than a change of the target.
  std::int64_t start_ns_ = std::chrono::steady_clock::now().time_since_epoch().count() + 3'600'000'000'000;
};

TEST(PhysicalMeasures, FindTheDriftOfACameraThatIsCorrectedOrCorrectsItself) {
  const SensorSpec sensor = *load_sensor("sc2000");
  const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  const TargetPlate plate = *load_plate("tcat-a");
  for (const bool commanded : {true, false}) {
    OpenedBench bench = simulated_bench(model, {plate}, 2, {});
    DriftingCamera camera(*bench.camera, commanded);
    CameraMeasuresOptions options = drift_options(sensor, plate, commanded ? 6 : 20);
    options.measurement.nuc_interval_s = 100, options.measurement.nuc_wait_s = 0.2;

    const auto measures = measure_camera(camera, *bench.target, options, *bench.host, {});

    ASSERT_TRUE(measures) << measures.error().message;
    EXPECT_THAT(measures->reasons, ::testing::IsEmpty());
    ASSERT_TRUE(measures->drift);
    const DriftMeasure& drift = *measures->drift;
    EXPECT_EQ(drift.ended_by_correction, !commanded);
    EXPECT_GE(drift.groups, commanded ? 19 : 8);
    EXPECT_NEAR(drift.first_s, 0.3, 0.5);
    EXPECT_EQ(drift.law.level.shape, DriftShape::linear);
    EXPECT_EQ(drift.law.pattern.shape, DriftShape::linear);
    const double watched_s = drift.law.time_s.back() - drift.law.time_s.front();
    const auto off = [&](const DriftFit& fit, double rate) {
      const double half = 0.5 * (fit.change_ci95.high.value() - fit.change_ci95.low.value());
      return std::abs(fit.change_k - rate * watched_s) / half;
    };
    // Two half-widths are four standard uncertainties.
    EXPECT_LT(off(drift.law.level, DriftingCamera::level_k_per_s), 2);
    EXPECT_LT(off(drift.law.pattern, DriftingCamera::pattern_k_per_s), 2);
    EXPECT_GT(drift.law.level.change_ci95.low.value(), 0.9 * DriftingCamera::level_k_per_s * watched_s);
    EXPECT_GT(drift.law.pattern.change_ci95.low.value(), 0.9 * DriftingCamera::pattern_k_per_s * watched_s);
    const Json written = measures_json(*measures, std::nullopt);
    const auto record = measures_from(written);
    ASSERT_TRUE(record) << record.error().message;
    EXPECT_EQ(record->main->drift->law.pattern.seen_k, drift.law.pattern.seen_k);
    EXPECT_NEAR(line_of(record->main, "drift_rate")->value.value(), 60 * DriftingCamera::level_k_per_s, 0.1);
    Json cut = written;
    cut["main"]["drift"]["level"]["seen_k"].erase(0);
    EXPECT_FALSE(measures_from(cut));
  }
}

TEST(PhysicalMeasures, HaveAReasonWhereNoCorrectionComes) {
  const SensorSpec sensor = *load_sensor("sc2000");
  const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  const TargetPlate plate = *load_plate("tcat-a");
  OpenedBench bench = simulated_bench(model, {plate}, 2, {});
  DriftingCamera camera(*bench.camera, true);
  CameraMeasuresOptions options = drift_options(sensor, plate, 2);

  const auto measures = measure_camera(camera, *bench.target, options, *bench.host, {});

  ASSERT_TRUE(measures) << measures.error().message;
  EXPECT_FALSE(measures->drift);
  ASSERT_EQ(measures->reasons.size(), 1u);
  EXPECT_THAT(measures->reasons[0], HasSubstr("drift"));
  camera.stands_still = true;
  options.measurement.nuc_interval_s = 100;
  const auto still = measure_camera(camera, *bench.target, options, *bench.host, {});
  ASSERT_TRUE(still) << still.error().message;
  EXPECT_FALSE(still->drift);
}

}  // namespace
}  // namespace todbench
