// SPDX-License-Identifier: GPL-3.0-or-later
// Response time that a plan asks for: of sensors whose time constant is known, and in a session.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/plan/descriptions.h"
#include "bench/plan/plan_keys.h"
#include "bench/report/report.h"
#include "bench/run/experiment.h"
#include "bench/run/report_data.h"
#include "bench/session/measures_record.h"
#include "bench/session/open_session.h"
#include "sim_devices/sensor/contrast_steps.h"
#include "tests/bench/run/measures_plan.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::plan_of_one;
using testing::TemporaryFolder;

TEST(ContrastStepsOfASensor, AreTakenInAsFirstOrderOverTheExposure) {
  SensorSpec sensor;
  sensor.time_constant_ms = 10, sensor.exposure_ms = 4;
  ContrastSteps steps(2);
  steps.step(1.0, 5);
  steps.step(1.012, 3);
  // The mean of a fine sum over the exposure, by the closed form of two steps.
  const auto level = [](double t) {
    if (t < 1) return 2.0;
    if (t < 1.012) return 5 - 3 * std::exp(-(t - 1) / 0.01);
    const double at = 5 - 3 * std::exp(-1.2);
    return 3 + (at - 3) * std::exp(-(t - 1.012) / 0.01);
  };
  for (const double end_s : {0.9, 1.001, 1.004, 1.013, 1.02, 1.05, 1.6}) {
    constexpr int parts = 20000;
    double mean = 0;
    for (int i = 0; i < parts; ++i) mean += level(end_s - 0.004 * (i + 0.5) / parts) / parts;
    EXPECT_NEAR(steps.seen_k(end_s, sensor), mean, 1e-6) << end_s;
  }
  EXPECT_EQ(steps.seen_k(2.0, sensor), 3.0);
  sensor.time_constant_ms = sensor.exposure_ms = 0;
  EXPECT_EQ(steps.seen_k(1.013, sensor), 3.0);
}

CameraMeasuresOptions response_of(const SensorSpec& sensor, const TargetPlate& plate) {
  CameraMeasuresOptions options;
  options.response = ResponseOptions{.plate = {}, .settling_s = {}};
  options.transfer_steps_k = {16.9};
  options.measurement.ifov_mrad = sensor.ifov_mrad();
  options.measurement.distance_m = 2;
  options.measurement.plates = {plate};
  options.measurement.registration_frames = 4;
  options.measurement.contrast_frames = 8;
  return options;
}

TEST(PhysicalMeasures, FindTheTimeConstantOfASimulatedSensor) {
  SensorSpec sensor = *load_sensor("sc2000");
  sensor.time_constant_ms = 12, sensor.exposure_ms = 4;
  const auto model =
      std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}, any_motion), Accuracy::draft(), 1);
  const TargetPlate plate = *load_plate("tcat-a");
  OpenedBench bench = simulated_bench(model, {plate}, 2, {});
  CameraMeasuresOptions options = response_of(sensor, plate);
  options.response->delta_t_k = -10;

  const auto measures = measure_camera(*bench.camera, *bench.target, options, *bench.host, {});

  ASSERT_TRUE(measures) << measures.error().message;
  EXPECT_THAT(measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(measures->response);
  const StepTimeConstant& found = measures->response->response.both;
  // Two half-widths are four standard uncertainties.
  EXPECT_NEAR(found.value_s, 0.012, found.high_s - found.low_s);
  EXPECT_LT(found.high_s - found.low_s, 0.1 * 0.012);
  EXPECT_EQ(found.steps, 16);
  EXPECT_NEAR(measures->response->frame_s, 0.02, 1e-9);
  ASSERT_TRUE(measures->response->response.rise && measures->response->response.fall);
  const auto record = measures_from(measures_json(*measures, std::nullopt));
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_NEAR(line_of(record->main, "response_time")->value.value(), 1e3 * found.value_s, 1e-9);
  EXPECT_NEAR(line_of(record->main, "response_time_fall")->ci95.high.value(),
              1e3 * measures->response->response.fall->high_s, 1e-9);
  EXPECT_EQ(record->main->response->response.points, measures->response->response.points);
}

/// A target that steps only by being presented, as instruments do: the camera is not told when.
class PresentedOnly : public Target {
 public:
  explicit PresentedOnly(Target& target) : target_(target) {}
  const TargetCapabilities& capabilities() const override { return target_.capabilities(); }
  Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    return target_.present(state, stop);
  }

 private:
  Target& target_;
};

TEST(PhysicalMeasures, HaveAReasonWhereNoResponseTimeIsSeen) {
  const SensorSpec sensor = *load_sensor("sc2000");
  const auto model =
      std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}, any_motion), Accuracy::draft(), 1);
  const TargetPlate plate = *load_plate("tcat-a");
  OpenedBench bench = simulated_bench(model, {plate}, 2, {});
  const CameraMeasuresOptions options = response_of(sensor, plate);
  PresentedOnly unknown(*bench.target);

  // A detector without memory; a target whose settling nobody states.
  for (Target* target : {bench.target.get(), static_cast<Target*>(&unknown)}) {
    const auto measures = measure_camera(*bench.camera, *target, options, *bench.host, {});

    ASSERT_TRUE(measures) << measures.error().message;
    EXPECT_FALSE(measures->response);
    ASSERT_EQ(measures->reasons.size(), 1u);
    EXPECT_THAT(measures->reasons[0], HasSubstr("response time"));
  }
}

TEST(PhysicalMeasures, OfASessionHaveTheResponseTimeBesideThatOfTheTwin) {
  const TemporaryFolder folder;
  Plan plan = plan_of_one(&MeasuresPlan::response);
  const std::string text = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  plan.simulation.sensor = folder.write("bolometer.toml", text + "\ntime_constant_ms = 10\n").string();
  plan.camera.id = "sim:" + plan.simulation.sensor;
  plan.limits.measures = {{"response_time", std::nullopt, 14}};

  const auto outcome = measure_plan(plan, {.folder = folder.path() / "session"}, {}, {});

  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(outcome->ended_by) << outcome->ended_by->message;
  const auto session = open_session(folder.path() / "session", {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->measures && session->measures->main && session->measures->twin);
  for (const auto* side : {&session->measures->main, &session->measures->twin}) {
    const auto* line = line_of(*side, "response_time");
    ASSERT_NE(line, nullptr);
    // Two half-widths are four standard uncertainties.
    EXPECT_NEAR(line->value.value(), 10, line->ci95.high.value() - line->ci95.low.value());
    EXPECT_LT(line->ci95.high.value() - line->ci95.low.value(), 2);
  }
  EXPECT_EQ(line_of(session->measures->twin, "response_time_model")->value, 10);
  const auto& demands = outcome->verdict.demands;
  const auto demand = std::find_if(demands.begin(), demands.end(),
                                   [](const Demand& one) { return one.kind == DemandKind{"response_time"}; });
  ASSERT_NE(demand, demands.end());
  EXPECT_EQ(demand->decision, VerdictKind::pass);
  EXPECT_THAT(render_report(*report_data(*session, "session")), HasSubstr("response-twin"));
}

TEST(PlanOfMeasures, NeedsTheSettlingOfATargetWhoseResponseTimeIsAsked) {
  Plan plan = plan_of_one(&MeasuresPlan::response);
  EXPECT_TRUE(mistakes_in(plan).empty());
  plan.measures.response_delta_t_k = 0;
  EXPECT_EQ(mistakes_in(plan).size(), 1u);
  plan.measures.response_delta_t_k = 10;
  plan.measures.response = false;
  plan.measures.noise = true;
  plan.limits.measures = {{"response_time", std::nullopt, 14}};
  EXPECT_EQ(mistakes_in(plan).size(), 1u);
  plan.measures.response = true;
  EXPECT_TRUE(mistakes_in(plan).empty());
  plan = *load_plan("demo");
  const std::size_t before = mistakes_in(plan).size();
  plan.measures.response = true;
  EXPECT_EQ(mistakes_in(plan).size(), before + 1);
  plan.measures.response_settling_ms = 2;
  EXPECT_EQ(mistakes_in(plan).size(), before);
}

}  // namespace
}  // namespace todbench
