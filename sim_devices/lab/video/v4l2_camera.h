// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated thermal camera with a V4L2 device node. Clients under the preload library of umockdev open the node,
// configure it by ioctl and map its buffers, as with a kernel driver.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/base/result.h"
#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/video/video_frames.h"

namespace todbench {

/// Differences of a driver from uvcvideo, and its faults.
struct VideoDriverQuirks {
  enum class Sizes { listed, stepwise, continuous, unlisted };
  Sizes sizes = Sizes::listed;   ///< unlisted: VIDIOC_ENUM_FRAMESIZES returns ENOTTY
  bool has_try_format = true;    ///< VIDIOC_TRY_FMT
  bool has_parameters = true;    ///< VIDIOC_G_PARM and VIDIOC_S_PARM
  int row_padding_bytes = 0;     ///< after every row, counted in sizeimage and bytesused
  bool states_row_bytes = true;  ///< bytesperline includes the padding
  std::string driver = "uvcvideo";
};

/// Camera that serves frames during its lifetime. The device node is a regular file, so that buffers can be mapped.
/// Therefore poll() on the node is always ready, and a DQBUF without a frame waits for up to 10 ms before it returns
/// EAGAIN. Otherwise the camera behaves like a driver. Buffers are filled in the order in which they were queued. An
/// exposure without a free buffer is lost and causes a gap in the sequence. A second program receives EBUSY while the
/// first program streams. An unplugged camera returns ENODEV, and udev announces its removal.
///
/// The timestamps of the buffers (of unknown base, in the terms of V4L2) are times of the camera's clock. The clock
/// advances by one frame period per exposure from power-up: exposure k has the time (k + 1) / rate. The camera exposes
/// only while a stream is running.
///
/// Methods may be called from any thread.
class EmulatedV4l2Camera {
 public:
  /// Returns picture number `exposure_index`, counted from 0 at power-up over all streams. Called on the camera's
  /// thread. Must return the configured geometry. After a wrong size or an exception the camera sends zeros and counts
  /// the exposure in failed_exposures().
  using Exposure = std::function<cv::Mat1w(std::uint64_t exposure_index)>;

  /// Plugs the camera in. Errors: `invalid_input` (configuration).
  [[nodiscard]] static Result<std::unique_ptr<EmulatedV4l2Camera>> start(std::shared_ptr<MockSystem> system,
                                                                         VideoCameraConfig config, Exposure exposure,
                                                                         VideoDriverQuirks quirks = {});
  /// Unplugs the camera.
  ~EmulatedV4l2Camera();
  EmulatedV4l2Camera(const EmulatedV4l2Camera&) = delete;
  EmulatedV4l2Camera& operator=(const EmulatedV4l2Camera&) = delete;

  /// Returns "/dev/video7", the path for clients under the preload library.
  [[nodiscard]] std::string node() const;
  [[nodiscard]] const VideoCameraConfig& config() const;
  /// Returns the number of exposures since power-up, including lost exposures.
  [[nodiscard]] std::uint64_t exposures() const;
  [[nodiscard]] std::uint64_t failed_exposures() const;
  [[nodiscard]] std::uint64_t nonuniformity_corrections() const;

  /// Pulls the cable: every call of a client fails from now on, and udev announces the removal.
  void unplug();
  /// Makes the next `count` exposures without sending them: a gap of exactly `count` frames.
  void lose_exposures(unsigned count);
  /// Sends the next frame with only this many bytes and the driver's mark for missing data.
  void truncate_next_frame(std::uint32_t bytes);
  /// Sends the next frame with only this many bytes and without the mark. Drivers do so if a transfer ended early
  /// although no data were lost on the bus.
  void shorten_next_frame(std::uint32_t bytes);
  /// States this size for the next frame, regardless of its true size.
  void misstate_next_frame(std::uint32_t bytes);
  /// Returns the next frame in a buffer of this index, regardless of the queue.
  void misplace_next_frame(std::uint32_t index);
  /// Sets the sequence number of the next frame.
  void restart_sequence(std::uint32_t number);

 private:
  struct State;
  explicit EmulatedV4l2Camera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
