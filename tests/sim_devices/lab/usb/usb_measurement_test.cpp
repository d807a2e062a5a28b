// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement through an emulated USB camera makes the decisions of the simulated camera for the same exposures.
#include <gmock/gmock.h>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/usb/usb_backend.h"
#include "sim_devices/lab/usb_laboratory.h"
#include "tests/sim_devices/lab/measured_twice.h"
#include "tests/support/usb_test_support.h"

namespace todbench {
namespace {

using test::ExposureOf;
using test::SimulatedBench;

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
          {"U3v", [&] { return connect_u3v(system(), {}); }, u3v, test::exposure_by_clock(test::twice_frame_rate_hz)}};
}

class UsbMeasurement : public testing::TestWithParam<UsbCameraCase> {};

TEST_P(UsbMeasurement, DecidesAsTheSimulatedCameraForTheSameExposures) {
  const SimulatedBench bench = test::bench_for_both();
  MeasurementOptions options = test::options_for_both(bench);
  options.nuc_wait_s = 0;  // the simulated camera has no shutter whose frames would be waited for
  test::MeasuredTwice both;
  ASSERT_NO_FATAL_FAILURE(test::measure_twice(
      bench, options,
      {.connect = GetParam().connect(), .backend = GetParam().backend(), .exposure_of = GetParam().exposure_of}, both));

  ASSERT_GE(both.measured.trials.size(), 2U * 2 * 3 * 20);  // plates, contrasts, phases, triangles
  test::expect_same_decisions(both.measured.trials, both.simulated.trials);
}

INSTANTIATE_TEST_SUITE_P(Every, UsbMeasurement, testing::ValuesIn(cameras()),
                         [](const auto& camera) { return camera.param.name; });

}  // namespace
}  // namespace todbench
