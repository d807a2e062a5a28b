// SPDX-License-Identifier: GPL-3.0-or-later
// The cameras of the fault matrix on USB: behind a kernel driver (V4L2), USB3 Vision, Seek.
#pragma once

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/core/control_text.h"
#include "acquisition/usb/usb_backend.h"
#include "acquisition/v4l2/v4l2_backend.h"
#include "sim_devices/lab/usb/u3v_camera.h"
#include "sim_devices/lab/v4l2_laboratory.h"
#include "tests/sim_devices/lab/driver_fault_matrix.h"
#include "tests/support/parameter_names.h"
#include "tests/support/usb_test_support.h"
#include "tests/support/video_test_support.h"

namespace todbench::test {

inline constexpr double driver_frame_rate_hz = 100;

/// Keeps a model of a device in its port.
struct PortAndSystem {
  std::shared_ptr<MockSystem> system;
  std::unique_ptr<PluggedUsbDevice> port;
};

inline std::shared_ptr<void> in_a_port(std::shared_ptr<UsbDevice> device) {
  auto system = testing_support::shared_system();
  auto port = PluggedUsbDevice::plug(system, std::move(device));
  if (!port) ADD_FAILURE() << port.error().message;
  return std::make_shared<PortAndSystem>(PortAndSystem{system, port ? std::move(*port) : nullptr});
}

inline DriverCase v4l2_case(VideoCameraKind kind) {
  DriverCase out{.name = name_of(kind),
                 .spec = with_counts_of(kind, sc2000()),
                 .faults = {DriverFault::lost, DriverFault::truncated, DriverFault::shortened, DriverFault::frozen,
                            DriverFault::swapped},
                 .truncated_is = Rejection::incomplete,
                 .plug = {}};
  out.spec.frame_rate_hz = driver_frame_rate_hz;
  out.plug = [kind](const SensorSpec& spec, std::function<cv::Mat1w(std::uint64_t)> exposure, FaultCommands& commands) {
    VideoCameraConfig config{.kind = kind};
    config.width = spec.width;
    config.height = spec.height;
    config.frame_rate_hz = spec.frame_rate_hz;
    auto started = EmulatedV4l2Camera::start(testing_support::shared_system(), config, std::move(exposure));
    EXPECT_TRUE(started);
    const std::shared_ptr<EmulatedV4l2Camera> camera = std::move(*started);
    commands.lose = [raw = camera.get()] { raw->lose_exposures(1); };
    // Less than a row: what arrives is no picture, whatever the layout.
    commands.truncate = [raw = camera.get()] { raw->truncate_next_frame(100); };
    commands.shorten = [raw = camera.get()] { raw->shorten_next_frame(1000); };
    return PluggedCamera{.id = testing_support::video_camera_id(config),
                         .device = camera,
                         .settings = {},
                         .backend = v4l2_backend(),
                         .exposure_of = exposure_by_clock(spec.frame_rate_hz)};
  };
  return out;
}

inline DriverCase u3v_case() {
  DriverCase out{.name = "U3v",
                 .spec = sc2000(),
                 .faults = {DriverFault::lost, DriverFault::truncated, DriverFault::frozen, DriverFault::swapped},
                 .truncated_is = Rejection::incomplete,
                 .plug = {}};
  out.spec.frame_rate_hz = driver_frame_rate_hz;
  out.spec.kelvin_per_count = 0.01;
  out.spec.offset_k = 0;
  out.spec.bits = 16;
  // The protocol marks nothing: the trailer says how many bytes came, and they are not those of a picture.
  out.truncated_is = Rejection::wrong_size;
  out.plug = [](const SensorSpec& spec, std::function<cv::Mat1w(std::uint64_t)> exposure, FaultCommands& commands) {
    U3vCameraConfig config;
    config.width = spec.width;
    config.height = spec.height;
    config.significant_bits = spec.bits;
    config.frame_rate_hz = spec.frame_rate_hz;
    config.kelvin_per_count = spec.kelvin_per_count;
    config.offset_k = spec.offset_k;
    const auto camera = *U3vCamera::create(config, std::move(exposure));
    commands.lose = [raw = camera.get()] { raw->lose_exposures(1); };
    commands.truncate = [raw = camera.get()] { raw->truncate_next_frame(1000); };
    return PluggedCamera{.id = camera_id("u3v", {config.vendor, config.serial}),
                         .device = in_a_port(camera),
                         .settings = {},
                         .backend = aravis_backend({.transport = AravisTransport::usb3_vision}),
                         .exposure_of = exposure_by_clock(spec.frame_rate_hz)};
  };
  return out;
}

inline DriverCase seek_case() {
  DriverCase out{.name = "Seek",
                 .spec = sc2000(),
                 .faults = {DriverFault::lost, DriverFault::truncated, DriverFault::frozen},
                 .truncated_is = Rejection::incomplete,
                 .plug = {}};
  out.spec.frame_rate_hz = driver_frame_rate_hz;
  out.plug = [](const SensorSpec& spec, std::function<cv::Mat1w(std::uint64_t)> exposure, FaultCommands& commands) {
    SeekCameraConfig config;
    config.frame_rate_hz = spec.frame_rate_hz;
    const auto camera = *SeekCamera::create(config, std::move(exposure));
    commands.lose = [raw = camera.get()] { raw->lose_exposures(1); };
    commands.truncate = [raw = camera.get()] { raw->truncate_next_frame(512 * 7); };
    return PluggedCamera{.id = testing_support::seek_id(config),
                         .device = in_a_port(camera),
                         .settings = {{"TemperatureLinearScale", control_text(spec.kelvin_per_count)},
                                      {"TemperatureLinearOffset", control_text(spec.offset_k)}},
                         .backend = usb_backend(),
                         .exposure_of = [](const Frame& frame) { return frame.sequence + seek_calibration_frames; }};
  };
  return out;
}

inline std::vector<DriverCase> driver_cases() {
  return {v4l2_case(VideoCameraKind::lepton), v4l2_case(VideoCameraKind::temperature_rows), u3v_case(), seek_case()};
}

/// A camera, its faults, and how often they come.
struct DriverCell {
  DriverCase camera;
  std::vector<DriverFault> faults;
  double rate = 0;
};

inline void PrintTo(const DriverCell& cell, std::ostream* out) {
  *out << cell.camera.name;
}

inline std::string name_of(const testing::TestParamInfo<DriverCell>& cell) {
  const std::string fault = cell.param.faults.size() == 1 ? to_text(cell.param.faults.front()) : "AllAtOnce";
  return cell.param.camera.name + fault + "At" + std::to_string(std::lround(1000 * cell.param.rate)) + "PerMille";
}

/// Every fault of every camera at these rates.
inline std::vector<DriverCell> every_fault(const std::vector<double>& rates) {
  std::vector<DriverCell> out;
  for (const auto& camera : driver_cases()) {
    for (const auto fault : camera.faults) {
      for (const double rate : rates) out.push_back({camera, {fault}, rate});
    }
  }
  return out;
}

/// The faults of every camera mixed, at these rates.
inline std::vector<DriverCell> all_faults_at_once(const std::vector<double>& rates) {
  std::vector<DriverCell> out;
  for (const auto& camera : driver_cases()) {
    for (const double rate : rates) out.push_back({camera, camera.faults, rate});
  }
  return out;
}

}  // namespace todbench::test
