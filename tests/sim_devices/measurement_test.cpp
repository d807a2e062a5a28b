// The measurement on simulated cameras: known answers, agreement with the direct estimate, and faults.
#include "tod/measurement.h"

#include <gmock/gmock.h>

#include <cmath>

#include "hvs/template_observer.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tests/sim_devices/reference.h"
#include "tests/sim_devices/test_plates.h"
#include "tod/tod_curve.h"

namespace todbench {
namespace {

struct Bench {
  SensorSpec spec = test::sc2000();
  std::vector<TargetPlate> plates = test::two_plates();
  std::vector<double> contrasts{16.9, 1.93, 0.23};
  int phases = 4;
  std::uint64_t seed = 1;
};

MeasurementOptions options_of(const Bench& bench) {
  MeasurementOptions options;
  options.ifov_mrad = bench.spec.ifov_mrad();
  options.distance_m = 2;
  options.plates = bench.plates;
  options.frames_after_change = 0;
  options.seed = bench.seed;
  return options;
}

Result<MeasurementResult> run(const Bench& bench, Observer& observer, const MeasurementListener& listener = {}, std::stop_token stop = {}) {
  const auto model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::normal(), bench.seed);
  PlateScene scene;
  scene.plate = bench.plates.front();
  const auto holder = std::make_shared<SceneHolder>(scene);
  const auto source = simulated_source(model, holder, "1");
  const auto target = scene_target(holder, bench.plates);
  ConstantStimuliOptions stimuli;
  for (const auto& plate : bench.plates) stimuli.plates.push_back(plate.name);
  stimuli.mountings.assign(all_mountings.begin(), all_mountings.end());
  stimuli.delta_t_k = bench.contrasts;
  stimuli.phases = bench.phases;
  stimuli.pixel_mm = 2 * bench.spec.ifov_mrad();
  ListedSchedule schedule(constant_stimuli(stimuli, RandomStream(bench.seed, "schedule")));
  return measure(*source, *target, observer, schedule, options_of(bench), listener, stop);
}

TEST(Measurement, OfTheSimulatedSC2000AgreesWithTheDirectEstimate) {
  Bench bench;
  bench.phases = 12;
  TemplateObserver observer({}, triangle_alternatives());

  const auto result = run(bench, observer);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_FALSE(result->ended_by.has_value());
  const auto curve = tod_curve(result->trials, {});
  ASSERT_TRUE(curve.has_value());
  const auto direct = direct_estimate(bench.spec, full_plan(bench.spec, {}, {}), observer, bench.contrasts, {});
  ASSERT_TRUE(direct.has_value());
  ASSERT_EQ(curve->points.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& point = curve->points[i];
    const double expected = (*direct)[i].s75_pitch * bench.spec.ifov_mrad();
    ASSERT_TRUE(point.fit.threshold.has_value());
    std::printf("dT %.2f (measured %.4f): S75 %.4f [%.4f, %.4f] mrad, direct %.4f, inflation %.2f, %g trials\n", point.set_delta_t_k,
                point.delta_t_k, *point.fit.threshold, *point.fit.ci95.low, *point.fit.ci95.high, expected,
                point.fit.variance_inflation, point.fit.trials);
    // Form of the psychometric function: bias up to 4 % (facts of the direct estimate's source); three standard errors.
    EXPECT_NEAR(*point.fit.threshold, expected, 0.04 * expected + 1.5 * (*point.fit.ci95.high - *point.fit.threshold));
  }
}

}  // namespace
}  // namespace todbench
