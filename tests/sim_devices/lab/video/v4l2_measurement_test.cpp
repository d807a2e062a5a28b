// A measurement through an emulated V4L2 camera makes the decisions of the simulated camera for the same exposures.
#include <gmock/gmock.h>

#include <algorithm>

#include "acquisition/v4l2/v4l2_backend.h"
#include "sim_devices/lab/v4l2_laboratory.h"
#include "sim_devices/lab/video/v4l2_camera.h"
#include "tests/support/parameter_names.h"
#include "tests/tod/measurement/free_running_camera.h"
#include "tests/tod/measurement/measurement_bench.h"

namespace todbench {
namespace {

using test::ExposureLog;
using test::GivenExposures;
using test::options_of;
using test::PresentScene;
using test::schedule_of;
using test::SimulatedBench;

class V4l2Measurement : public testing::TestWithParam<VideoCameraKind> {};

/// A measurement through the node, and that of the simulated camera over the exposures that came through it, without
/// those that arrived short.
struct Both {
  MeasurementResult measured, simulated;
  std::uint64_t arrived_short = 0;
};

void measure_both(VideoCameraConfig config, Both& both) {
  SimulatedBench bench;
  bench.spec = with_counts_of(config.kind, bench.spec);
  bench.spec.frame_rate_hz = 100;
  bench.contrasts = {1.93, 0.23};
  bench.mountings = {Mounting::identity};
  bench.phases = 3;
  TemplateObserver observer({}, triangle_alternatives());
  MeasurementOptions options = options_of(bench);
  options.registration_frames = 8;
  options.contrast_frames = 8;
  options.frame_timeout = std::chrono::seconds(20);
  options.max_rejected_share = 0.2;
  const SensorModel model(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::normal(), 1);
  PlateScene empty;
  empty.distance_m = bench.distance_m;
  SceneHolder before_camera(empty);
  ExposureLog log;
  const auto camera = connect_v4l2(MockSystem::create(), config)(bench.spec, [&](std::uint64_t index) {
    auto scene = before_camera.scene();
    log.add(index, scene);
    return model.expose(*scene, index);
  });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = v4l2_backend()->open((*camera)->id());
  ASSERT_TRUE(source) << source.error().message;
  const auto share = [](SceneHolder& holder) { return std::shared_ptr<SceneHolder>(&holder, [](SceneHolder*) {}); };

  PresentScene fresh(**source, before_camera, log, test::exposure_by_clock(bench.spec.frame_rate_hz));
  auto schedule = schedule_of(bench);
  const auto measured = measure(fresh, *scene_target(share(before_camera), bench.plates), observer, schedule, options,
                                *bench.host, {}, {});
  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by) << measured->ended_by->message;

  SceneHolder before_simulation(empty);
  const auto is_short = [&](std::uint64_t exposure) { return arrives_short(config, exposure); };
  GivenExposures given(fresh.info(), model, before_simulation, fresh.exposures(), is_short);
  auto same_schedule = schedule_of(bench);
  const auto simulated = measure(given, *scene_target(share(before_simulation), bench.plates), observer, same_schedule,
                                 options, *bench.host, {}, {});
  ASSERT_TRUE(simulated) << simulated.error().message;
  const auto exposures = fresh.exposures();
  both = {.measured = *measured,
          .simulated = *simulated,
          .arrived_short = static_cast<std::uint64_t>(std::count_if(exposures.begin(), exposures.end(), is_short))};
}

TEST_P(V4l2Measurement, DecidesAsTheSimulatedCameraForTheSameExposures) {
  Both both;
  ASSERT_NO_FATAL_FAILURE(measure_both({.kind = GetParam()}, both));

  ASSERT_GE(both.measured.trials.size(), 2U * 2 * 3 * 20);  // plates, contrasts, phases, triangles
  test::expect_same_decisions(both.measured.trials, both.simulated.trials);
}

TEST_P(V4l2Measurement, FramesOfAnotherSizeAreCountedAndNeverMeasured) {
  // Registration and contrast take 16 frames in succession: there is a short one among them.
  Both both;
  ASSERT_NO_FATAL_FAILURE(measure_both({.kind = GetParam(), .short_frame_interval = 10}, both));

  EXPECT_GT(both.arrived_short, 0U);
  EXPECT_EQ(both.measured.frames_rejected, (std::map<std::string, std::uint64_t>{{"wrong_size", both.arrived_short}}));
  EXPECT_EQ(both.measured.frames_lost, 0U);
  ASSERT_GE(both.measured.trials.size(), 2U * 2 * 3 * 20);
  test::expect_same_decisions(both.measured.trials, both.simulated.trials);
}

std::string name_of(const testing::TestParamInfo<VideoCameraKind>& kind) {
  return test::name_of(kind.param);
}

INSTANTIATE_TEST_SUITE_P(Every, V4l2Measurement,
                         testing::Values(VideoCameraKind::lepton, VideoCameraKind::temperature_rows), name_of);

}  // namespace
}  // namespace todbench
