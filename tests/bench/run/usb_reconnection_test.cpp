// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement whose USB camera is unplugged in mid-run and plugged in again, into another port: as it was after
// power-up, with the same serial number.
#include <gmock/gmock.h>

#include "bench/devices/reconnecting_source.h"
#include "tests/sim_devices/lab/driver_fault_cameras.h"

namespace todbench {
namespace {

using namespace test;

/// A camera that can be unplugged; every time it is plugged in it is one that was just switched on.
class PortOf {
 public:
  PortOf(const DriverCase& camera, const DriverBench& bench) : camera_(camera), bench_(bench) { plug_in(); }
  void plug_in() {
    exposures.push_back(std::make_shared<FaultyExposures>(bench_.model, bench_.holder, FaultDraw({}, 0)));
    plugged = camera_.plug(
        bench_.spec, [now = exposures.back()](std::uint64_t index) { return now->expose(index); },
        exposures.back()->commands);
  }
  void unplug() { plugged->device.reset(); }
  std::vector<std::shared_ptr<FaultyExposures>> exposures;  ///< one for every time that it was plugged in
  std::optional<PluggedCamera> plugged;

 private:
  const DriverCase& camera_;
  const DriverBench& bench_;
};

/// What the plan sets, other than the camera is after power-up where it can be.
std::map<std::string, std::string> settings_of(const DriverCase& camera, const PluggedCamera& plugged) {
  auto out = plugged.settings;
  if (camera.name == "U3v") out["IRFormat"] = "TemperatureLinear100mK";
  return out;
}

class UsbReconnection : public testing::TestWithParam<DriverCase> {};

TEST_P(UsbReconnection, InAnotherPortMakesEveryTrialWithEverySettingAsItWas) {
  const DriverBench bench(GetParam().spec, 4);
  PortOf port(GetParam(), bench);
  const auto settings = settings_of(GetParam(), *port.plugged);
  auto opened = port.plugged->backend->open(port.plugged->id);
  ASSERT_TRUE(opened) << opened.error().message;
  int attempts = 0;
  ReconnectingSource source(std::move(*opened),
                            [&]() -> Result<std::unique_ptr<FrameSource>> {
                              // The first two attempts find no camera.
                              if (++attempts == 3) port.plug_in();
                              return port.plugged->backend->open(port.plugged->id);
                            },
                            {.settings = settings});
  for (const auto& [name, value] : settings) ASSERT_TRUE(source.set(name, value)) << name;
  bench.host->bring_back = [&](std::stop_token stop) { return source.recover(std::move(stop)); };
  bench.host->confirm = [&] { source.confirm_registration(); };
  MeasurementListener listener;
  listener.on_progress = [&](std::size_t done, std::size_t) {
    // Whether the camera takes the command or not: what it says of itself is read anew.
    if (done == 1) static_cast<void>(source.correct_nonuniformity());
    if (done == 3) port.unplug();
  };
  RememberingSource remembering(source);

  const auto measured = bench.measure_with(remembering, monotonic_ns, listener);

  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by) << measured->ended_by->message;
  EXPECT_EQ(attempts, 3);
  EXPECT_EQ(source.state(), LinkState::streaming);
  EXPECT_EQ(measured->trials.size(), 2U * 4U * 20U);
  ASSERT_EQ(measured->interruptions.size(), 1U);
  EXPECT_EQ(measured->interruptions.front().presentation, 3);
  EXPECT_LT(measured->interruptions.front().moved_px, 0.1);
  for (const auto& [name, value] : settings) EXPECT_EQ(source.info().settings.at(name), value) << name;
  for (const auto& [name, value] : settings) EXPECT_EQ(*source.get(name), value) << name;
  std::uint64_t last = 0;
  for (const auto& frame : remembering.frames) {
    EXPECT_TRUE(&frame == &remembering.frames.front() || frame.sequence > last) << frame.sequence;
    last = frame.sequence;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, UsbReconnection, testing::ValuesIn(driver_cases()),
                         [](const auto& camera) { return camera.param.name; });

}  // namespace
}  // namespace todbench
