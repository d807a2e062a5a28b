// A Seek Thermal camera that exists only as a program: a USB device that speaks the protocol of the Compact and the
// CompactPRO. PluggedUsbDevice gives it to libusb.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "acquisition/usb/seek_protocol.h"
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

struct SeekCameraConfig {
  SeekModel model = SeekModel::compact_pro;
  std::string serial = "TB0001";        ///< in the descriptors; empty: only the chip has a number
  double frame_rate_hz = 50;            ///< 0.1 ... 1000; real ones send 7 ... 15
  int shutter_interval_frames = 0;      ///< the shutter closes for one frame after so many; 0: only at the start
  int fixed_pattern_counts = 64;        ///< offsets of the pixels are up to so many counts, as the shutter frame shows
  std::vector<cv::Point> dead{};        ///< of the picture; sent as zero
  std::uint16_t first_counter = 65400;  ///< of the frame after power-up: every longer run tests the client's unwrapping
};

/// The camera. After initialisation it sends a calibration frame, one of another kind, a shutter frame, then pictures.
/// It exposes only when it is asked for a frame, never sooner than a frame period after the frame before: nothing is
/// lost because a client is slow. Methods may be called from any thread.
class SeekCamera : public UsbDevice {
 public:
  /// Picture of exposure `index`, which counts every frame since power-up, those of calibration included: after one
  /// start the first picture has index seek_calibration_frames. Of the picture's geometry, counts up to 16383; called
  /// on the thread of the bulk endpoint.
  using Exposure = std::function<cv::Mat1w(std::uint64_t index)>;

  /// Errors: `invalid_input` (configuration).
  [[nodiscard]] static Result<std::shared_ptr<SeekCamera>> create(SeekCameraConfig config, Exposure exposure);

  [[nodiscard]] virtual std::uint64_t exposures() const = 0;
  /// The next `count` exposures happen but are never sent.
  virtual void lose_exposures(unsigned count) = 0;
  /// Of the next frame only the first `bytes` are sent.
  virtual void truncate_next_frame(std::size_t bytes) = 0;
};

/// Frames that the camera sends before the first picture.
inline constexpr int seek_calibration_frames = 3;

}  // namespace todbench
