// A thermal camera that exists only as a program, behind a V4L2 device node: clients under umockdev's preload library
// open it, set it up by ioctl and map its buffers as those of a kernel driver.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/core/result.h"
#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/video/video_frames.h"

namespace todbench {

/// What a driver does otherwise than uvcvideo, or wrong.
struct VideoDriverQuirks {
  enum class Sizes { listed, stepwise, continuous, unlisted };
  Sizes sizes = Sizes::listed;   ///< unlisted: VIDIOC_ENUM_FRAMESIZES is ENOTTY
  bool has_try_format = true;    ///< VIDIOC_TRY_FMT
  bool has_parameters = true;    ///< VIDIOC_G_PARM and VIDIOC_S_PARM
  int row_padding_bytes = 0;     ///< behind every row, counted in sizeimage and bytesused
  bool states_row_bytes = true;  ///< bytesperline counts the padding
  std::string driver = "uvcvideo";
};

/// Serves frames while it lives. The node is a regular file, so that buffers can be mapped: poll() on it is always
/// ready, and a DQBUF without a frame waits for up to 10 ms before it says EAGAIN. Everything else is as with a driver:
/// buffers are filled in the order in which they were queued, an exposure without a free buffer is lost and leaves a
/// gap in the sequence, one program streams at a time and another one is told EBUSY, an unplugged camera says ENODEV
/// and udev announces it.
///
/// The camera's clock, in the timestamps of the buffers (of unknown base, as V4L2 calls it), advances by one frame
/// period per exposure from power-up; exposure k has the time (k + 1) / rate. It exposes only while it streams.
///
/// Methods may be called from any thread.
class EmulatedV4l2Camera {
 public:
  /// Picture number `exposure_index`, counted from 0 at power-up over all streams; called on the camera's thread. Must
  /// return the configured geometry; a wrong size or an exception is sent as zeros and counted in failed_exposures().
  using Exposure = std::function<cv::Mat1w(std::uint64_t exposure_index)>;

  /// Plugs the camera in. Errors: `invalid_input` (configuration).
  [[nodiscard]] static Result<std::unique_ptr<EmulatedV4l2Camera>> start(std::shared_ptr<MockSystem> system,
                                                                         VideoCameraConfig config, Exposure exposure,
                                                                         VideoDriverQuirks quirks = {});
  /// Unplugs it.
  ~EmulatedV4l2Camera();
  EmulatedV4l2Camera(const EmulatedV4l2Camera&) = delete;
  EmulatedV4l2Camera& operator=(const EmulatedV4l2Camera&) = delete;

  /// "/dev/video7" as clients under the preload library see it.
  [[nodiscard]] std::string node() const;
  [[nodiscard]] const VideoCameraConfig& config() const;
  /// Exposures since power-up, lost ones included.
  [[nodiscard]] std::uint64_t exposures() const;
  [[nodiscard]] std::uint64_t failed_exposures() const;
  [[nodiscard]] std::uint64_t nonuniformity_corrections() const;

  /// Pulls the cable: every call of a client fails from now on, udev announces the removal.
  void unplug();
  /// The next `count` exposures happen but are never sent: a gap of exactly `count` frames.
  void lose_exposures(unsigned count);
  /// The next frame is sent with the driver's mark for missing data and only this many bytes.
  void truncate_next_frame(std::uint32_t bytes);
  /// The next frame is sent with only this many bytes, as if that were all of it: drivers do so when a transfer ended
  /// early and nothing was missing on the bus.
  void shorten_next_frame(std::uint32_t bytes);
  /// The next frame is said to have this many bytes, whatever it has.
  void misstate_next_frame(std::uint32_t bytes);
  /// The next frame is returned in a buffer of this index, whatever was queued.
  void misplace_next_frame(std::uint32_t index);
  /// The next frame has this sequence number.
  void restart_sequence(std::uint32_t number);

 private:
  struct State;
  explicit EmulatedV4l2Camera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
