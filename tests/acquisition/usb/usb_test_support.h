// What tests with an emulated Seek camera share. Programs run under umockdev's preload library.
#pragma once

#include <memory>
#include <string>

#include "acquisition/core/frame_source.h"
#include "sim_devices/lab/usb/seek_camera.h"
#include "sim_devices/lab/usb/usbfs_host.h"

namespace todbench::testing_support {

/// The one bus of the program: Aravis looks for USB cameras through a context that it makes once.
[[nodiscard]] std::shared_ptr<MockSystem> shared_system();

/// A camera on a bus; destroyed in the right order.
struct SeekBench {
  std::shared_ptr<MockSystem> system;
  std::shared_ptr<SeekCamera> camera;
  std::unique_ptr<PluggedUsbDevice> port;
};

/// Picture `index`, 14 bits: no pixel has the value of its neighbours, none is zero or at full scale.
[[nodiscard]] cv::Mat1w seek_picture(SeekModel model, std::uint64_t index);
/// A camera that shows seek_picture(), or `exposure`; fails the test when it cannot be plugged in.
[[nodiscard]] SeekBench plug_seek(const SeekCameraConfig& config, SeekCamera::Exposure exposure = {});
[[nodiscard]] std::string seek_id(const SeekCameraConfig& config);
/// Opens the camera by identity; fails the test when it cannot.
[[nodiscard]] std::unique_ptr<FrameSource> open_seek(const SeekCameraConfig& config);

}  // namespace todbench::testing_support
