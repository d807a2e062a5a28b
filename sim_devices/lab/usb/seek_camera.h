// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated Seek Thermal camera: a USB device with the protocol of the Compact and the CompactPRO. PluggedUsbDevice
// connects the camera to libusb.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/usb/seek_protocol.h"
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// Configuration of the camera.
struct SeekCameraConfig {
  SeekModel model = SeekModel::compact_pro;
  std::string serial = "TB0001";    ///< serial number in the descriptors; empty: only the chip has a number
  double frame_rate_hz = 50;        ///< 0.1 ... 1000; real cameras send 7 ... 15
  int shutter_interval_frames = 0;  ///< frames between closings of the shutter for one frame; 0: only at the start
  int fixed_pattern_counts = 64;    ///< largest offset of a pixel in counts; the shutter frame shows the offsets
  std::vector<cv::Point> dead{};    ///< dead pixels of the picture; sent as zero
  /// Counter of the first frame after power-up. The counter wraps soon, so every longer run tests the unwrapping in the
  /// client.
  std::uint16_t first_counter = 65400;
};

/// Camera that sends, after its initialisation, a calibration frame, a frame of a different kind, a shutter frame, and
/// then pictures. The camera exposes only if the host requests data, at the earliest one frame period after the
/// previous frame. A slow client therefore loses no frames. Methods may be called from any thread.
class SeekCamera : public UsbDevice {
 public:
  /// Returns the picture of exposure `index`, with counts up to 16383. The index counts every frame since power-up,
  /// including calibration frames: after one start, the first picture has the index seek_calibration_frames. Called on
  /// the thread of the bulk endpoint.
  using Exposure = std::function<cv::Mat1w(std::uint64_t index)>;

  /// Creates the camera. Errors: `invalid_input` (configuration).
  [[nodiscard]] static Result<std::shared_ptr<SeekCamera>> create(SeekCameraConfig config, Exposure exposure);

  /// Returns the number of exposures since power-up.
  [[nodiscard]] virtual std::uint64_t exposures() const = 0;
  /// Makes the next `count` exposures without sending them.
  virtual void lose_exposures(unsigned count) = 0;
  /// Sends only the first `bytes` of the next frame.
  virtual void truncate_next_frame(std::size_t bytes) = 0;
};

/// Number of frames that the camera sends before the first picture.
inline constexpr int seek_calibration_frames = 3;

}  // namespace todbench
