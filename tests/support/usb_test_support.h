// SPDX-License-Identifier: GPL-3.0-or-later
// What tests with emulated USB cameras share. Programs run under umockdev's preload library.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "acquisition/core/frame_source.h"
#include "sim_devices/lab/usb/seek_camera.h"
#include "sim_devices/lab/usb/usbfs_host.h"
#include "tests/support/camera_passages.h"

namespace todbench::testing_support {

/// The one bus of the program: Aravis looks for USB cameras through a context that it makes once.
[[nodiscard]] std::shared_ptr<MockSystem> shared_system();

/// A camera on that bus; destroyed in the right order.
template <typename Camera>
struct UsbBench {
  std::shared_ptr<MockSystem> system;
  std::shared_ptr<Camera> camera;
  std::unique_ptr<PluggedUsbDevice> port;
};

/// Plugs a camera in; fails the test when there is none, or no port for it.
template <typename Camera>
[[nodiscard]] UsbBench<Camera> plug(Result<std::shared_ptr<Camera>> camera) {
  UsbBench<Camera> bench{.system = shared_system(), .camera = nullptr, .port = nullptr};
  if (!camera) {
    ADD_FAILURE() << camera.error().message;
    return bench;
  }
  bench.camera = *camera;
  auto port = PluggedUsbDevice::plug(bench.system, bench.camera);
  if (!port) {
    ADD_FAILURE() << port.error().message;
    return bench;
  }
  bench.port = std::move(*port);
  return bench;
}

/// Picture `index`, 14 bits: no pixel has the value of its neighbours, none is zero or at full scale.
[[nodiscard]] cv::Mat1w seek_picture(SeekModel model, std::uint64_t index);
/// A camera that shows seek_picture(), or `exposure`; fails the test when it cannot be plugged in.
[[nodiscard]] UsbBench<SeekCamera> plug_seek(const SeekCameraConfig& config, SeekCamera::Exposure exposure = {});
[[nodiscard]] std::string seek_id(const SeekCameraConfig& config);
/// Opens the camera by identity; fails the test when it cannot.
[[nodiscard]] std::unique_ptr<FrameSource> open_seek(const SeekCameraConfig& config);

}  // namespace todbench::testing_support
