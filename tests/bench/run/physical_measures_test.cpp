// Physical measures that a plan asks for: of the simulated sensor, whose noise and scale are known, and in a session.
#include "bench/run/physical_measures.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bench/plan/descriptions.h"
#include "bench/report/report.h"
#include "bench/run/experiment.h"
#include "bench/run/replay.h"
#include "bench/run/report_data.h"
#include "bench/session/open_session.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

Plan measures_plan() {
  Plan plan = *load_plan("demo");
  plan.camera = {};
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.target.kind = TargetKind::scene;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.target.delta_t_k = {16.9};
  plan.target.phases = 2;
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 2;
  plan.measurement.registration_frames = 4;
  plan.measurement.contrast_frames = 8;
  plan.limits = {};
  plan.measures.noise = true;
  plan.measures.noise_frames = 16;
  plan.measures.transfer = true;
  return plan;
}

const MeasureLine* line_of(const std::optional<MeasureLines>& side, std::string_view name) {
  if (!side) return nullptr;
  for (const MeasureLine& line : side->lines) {
    if (line.measure == name) return &line;
  }
  return nullptr;
}

TEST(PhysicalMeasures, FindTheNoiseAndTheScaleOfTheSimulatedSensor) {
  const TemporaryFolder folder;
  const SensorSpec sensor = *load_sensor("sc2000");

  const auto outcome = simulate_plan(measures_plan(), {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  ASSERT_TRUE(outcome->measures);
  EXPECT_THAT(outcome->measures->reasons, ::testing::IsEmpty());
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures);
  EXPECT_FALSE(session->measures->twin);
  const auto* noise = line_of(session->measures->main, "temporal_noise");
  const auto* slope = line_of(session->measures->main, "transfer_slope");
  const auto* netd = line_of(session->measures->main, "netd");
  const auto* pixels = line_of(session->measures->main, "noise_tvh");
  ASSERT_TRUE(noise && slope && netd && pixels);
  // White noise of the sensor and of rounding to its counts; four standard errors of a standard deviation from 16
  // frames of some ten thousand pixels are 0.8 %.
  const double expected_k = std::hypot(sensor.netd_k, sensor.kelvin_per_count / std::sqrt(12.0));
  EXPECT_NEAR(noise->value.value(), expected_k, 0.01 * expected_k);
  EXPECT_LT(noise->ci95.low.value(), noise->value.value());
  EXPECT_GT(noise->ci95.high.value(), noise->value.value());
  EXPECT_NEAR(pixels->value.value(), expected_k, 0.01 * expected_k);
  // The sensor's scale is right. A contrast from 8 frames and the medians of a few triangles is known to some 15 mK,
  // a slope over 8 K to 3 mK/K.
  EXPECT_NEAR(slope->value.value(), 1, 0.012);
  EXPECT_NEAR(netd->value.value(), noise->value.value() / slope->value.value(), 1e-9);
  // No rows, columns or whole frames flicker in it: their variances are below a hundredth of the pixels'.
  for (const char* name : {"noise_t", "noise_tv", "noise_th"}) {
    const auto* line = line_of(session->measures->main, name);
    ASSERT_NE(line, nullptr);
    EXPECT_LT(line->value.value(), 0.1 * expected_k) << name;
  }
}

TEST(PhysicalMeasures, StandBesideTheTwinInTheReportAndAreNotRepeatedByAReplay) {
  const TemporaryFolder folder;
  Plan plan = measures_plan();
  plan.measurement.record_frames = true;

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures && session->measures->main && session->measures->twin);
  const double camera = line_of(session->measures->main, "temporal_noise")->value.value();
  const double twin = line_of(session->measures->twin, "temporal_noise")->value.value();
  EXPECT_NEAR(camera, twin, 0.02 * twin);  // the camera is the same sensor here
  const auto data = report_data(*session, "session");
  ASSERT_TRUE(data) << data.error().message;
  const std::string page = render_report(*data);
  EXPECT_THAT(page, HasSubstr("Physical measures"));
  EXPECT_THAT(page, HasSubstr("3-D noise tvh"));
  const auto replayed = replay_session(folder.path() / "session", {.folder = folder.path() / "again"}, {}, {}, {});
  ASSERT_TRUE(replayed) << replayed.error().message;
  EXPECT_TRUE(replayed->same_trials);
  EXPECT_FALSE(replayed->run.measures);
}

TEST(PhysicalMeasures, AreNotThereWhereNoneIsAskedForAndHaveAReasonWhereTheyCannotBe) {
  const TemporaryFolder folder;
  Plan none = measures_plan();
  none.measures = {};
  Plan unseen = measures_plan();
  unseen.measures.noise = false;
  unseen.measures.transfer_steps_k = {-0.02, 0.01, 0.02};

  const auto without = simulate_plan(none, {.folder = folder.path() / "none"}, {}, {});
  const auto lost = simulate_plan(unseen, {.folder = folder.path() / "unseen"}, {}, {});

  ASSERT_TRUE(without);
  EXPECT_FALSE(without->measures);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none" / "measures.json"));
  ASSERT_TRUE(lost) << lost.error().message;
  EXPECT_FALSE(lost->ended_by);
  ASSERT_TRUE(lost->measures);
  EXPECT_FALSE(lost->measures->transfer);
  ASSERT_EQ(lost->measures->reasons.size(), 1u);
  EXPECT_THAT(lost->measures->reasons[0], HasSubstr("finding the plate"));
}

TEST(PhysicalMeasures, ArePlannedWithThreeStepsOrMore) {
  Plan plan = measures_plan();
  plan.measures.transfer_steps_k = {1, 2, 1};
  const auto loaded = LoadedPlan::load(plan);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("transfer_steps_k"));
  EXPECT_THAT(loaded.error().message, HasSubstr("three steps or more"));
}

}  // namespace
}  // namespace todbench
