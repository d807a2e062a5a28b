// A measurement through an emulated USB camera makes the decisions of the simulated camera for the same exposures.
#include <gmock/gmock.h>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/usb/usb_backend.h"
#include "sim_devices/lab/usb_laboratory.h"
#include "tests/acquisition/usb/usb_test_support.h"
#include "tests/tod/measurement/free_running_camera.h"
#include "tests/tod/measurement/measurement_bench.h"

namespace todbench {
namespace {

using test::ExposureLog;
using test::ExposureOf;
using test::GivenExposures;
using test::options_of;
using test::PresentScene;
using test::schedule_of;
using test::SimulatedBench;

constexpr double frame_rate_hz = 100;

struct UsbCameraCase {
  std::string name;
  std::function<ConnectCamera()> connect;
  std::function<std::unique_ptr<CameraBackend>()> backend;
  ExposureOf exposure_of;
};

void PrintTo(const UsbCameraCase& camera, std::ostream* out) {
  *out << camera.name;
}

std::vector<UsbCameraCase> cameras() {
  const auto by_sequence = [](const Frame& frame) { return frame.sequence + seek_calibration_frames; };
  const auto u3v = [] { return aravis_backend({.transport = AravisTransport::usb3_vision}); };
  const auto& system = testing_support::shared_system;
  return {{"Seek", [&] { return connect_seek(system(), {}); }, [] { return usb_backend(); }, by_sequence},
          {"U3v", [&] { return connect_u3v(system(), {}); }, u3v, test::exposure_by_clock(frame_rate_hz)}};
}

class UsbMeasurement : public testing::TestWithParam<UsbCameraCase> {};

TEST_P(UsbMeasurement, DecidesAsTheSimulatedCameraForTheSameExposures) {
  SimulatedBench bench;
  bench.spec.frame_rate_hz = frame_rate_hz;
  bench.contrasts = {1.93, 0.23};
  bench.mountings = {Mounting::identity};
  bench.phases = 3;
  TemplateObserver observer({}, triangle_alternatives());
  MeasurementOptions options = options_of(bench);
  options.registration_frames = 8;
  options.contrast_frames = 8;
  options.frame_timeout = std::chrono::seconds(20);
  options.nuc_wait_s = 0;  // the simulated camera has no shutter whose frames would be waited for
  const SensorModel model(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::normal(), 1);
  PlateScene empty;
  empty.distance_m = bench.distance_m;
  SceneHolder before_camera(empty);
  ExposureLog log;
  const auto camera = GetParam().connect()(bench.spec, [&](std::uint64_t index) {
    auto scene = before_camera.scene();
    log.add(index, scene);
    return model.expose(*scene, index);
  });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = GetParam().backend()->open((*camera)->id());
  ASSERT_TRUE(source) << source.error().message;
  for (const auto& [name, value] : (*camera)->settings()) ASSERT_TRUE((*source)->set(name, value));
  const auto share = [](SceneHolder& holder) { return std::shared_ptr<SceneHolder>(&holder, [](SceneHolder*) {}); };

  PresentScene fresh(**source, before_camera, log, GetParam().exposure_of);
  auto schedule = schedule_of(bench);
  const auto measured = measure(fresh, *scene_target(share(before_camera), bench.plates), observer, schedule, options,
                                *bench.host, {}, {});
  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by) << measured->ended_by->message;

  SceneHolder before_simulation(empty);
  GivenExposures given(fresh.info(), model, before_simulation, fresh.exposures());
  auto same_schedule = schedule_of(bench);
  const auto simulated = measure(given, *scene_target(share(before_simulation), bench.plates), observer, same_schedule,
                                 options, *bench.host, {}, {});
  ASSERT_TRUE(simulated) << simulated.error().message;

  ASSERT_GE(measured->trials.size(), 2U * 2 * 3 * 20);  // plates, contrasts, phases, triangles
  test::expect_same_decisions(measured->trials, simulated->trials);
}

INSTANTIATE_TEST_SUITE_P(Every, UsbMeasurement, testing::ValuesIn(cameras()),
                         [](const auto& camera) { return camera.param.name; });

}  // namespace
}  // namespace todbench
