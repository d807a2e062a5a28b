// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated Seek Thermal camera: a USB device with the protocol of the Compact and the CompactPRO. PluggedUsbDevice
// connects it to libusb.
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

struct SeekCameraConfig {
  SeekModel model = SeekModel::compact_pro;
  std::string serial = "TB0001";    ///< in the descriptors; empty: only the chip has a number
  double frame_rate_hz = 50;        ///< 0.1 ... 1000; real ones send 7 ... 15
  int shutter_interval_frames = 0;  ///< the shutter closes for one frame after so many; 0: only at the start
  int fixed_pattern_counts = 64;    ///< largest offset of a pixel, which the shutter frame shows
  std::vector<cv::Point> dead{};    ///< dead pixels of the picture; sent as zero
  /// Counter of the first frame after power-up; it wraps soon, so that every longer run tests the client's unwrapping.
  std::uint16_t first_counter = 65400;
};

/// The camera. After initialisation it sends a calibration frame, one of another kind, a shutter frame, then pictures.
/// It exposes only on request, at the earliest one frame period after the frame before, so a slow client loses no
/// frames. Methods may be called from any thread.
class SeekCamera : public UsbDevice {
 public:
  /// Picture of exposure `index`, which counts every frame since power-up, calibration frames included: after one start
  /// the first picture has index seek_calibration_frames. It has the geometry of the picture and counts up to 16383.
  /// Called on the thread of the bulk endpoint.
  using Exposure = std::function<cv::Mat1w(std::uint64_t index)>;

  /// Errors: `invalid_input` (configuration).
  [[nodiscard]] static Result<std::shared_ptr<SeekCamera>> create(SeekCameraConfig config, Exposure exposure);

  [[nodiscard]] virtual std::uint64_t exposures() const = 0;
  /// The next `count` exposures are made but never sent.
  virtual void lose_exposures(unsigned count) = 0;
  /// Sends only the first `bytes` of the next frame.
  virtual void truncate_next_frame(std::size_t bytes) = 0;
};

/// Frames that the camera sends before the first picture.
inline constexpr int seek_calibration_frames = 3;

}  // namespace todbench
