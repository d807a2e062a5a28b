// SPDX-License-Identifier: GPL-3.0-or-later
// One open V4L2 capture node: the ioctls of streaming I/O with mapped buffers. Private to the V4L2 back end.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"
#include "acquisition/v4l2/video_layout.h"

namespace todbench {

/// Capabilities of a node as the driver reports them.
struct VideoCapability {
  std::string driver, card, bus;
  std::uint32_t version = 0;
  bool captures = false;  ///< single-planar capture with streaming
};

/// A frame in a driver's buffer; valid until the callback of take() returns.
struct VideoBuffer {
  std::span<const std::uint8_t> bytes;
  std::uint32_t sequence = 0;
  std::int64_t time_ns = 0;  ///< 0: none
  bool damaged = false;      ///< V4L2_BUF_FLAG_ERROR, or an empty buffer
  bool oversized = false;    ///< states more bytes than its buffer or the format can contain
};

/// An open node. Errors of every method: `disconnected` if the device is gone (ENODEV), otherwise as stated. Not
/// thread-safe; the source serialises the calls.
class VideoDevice {
 public:
  /// Opens a node. Error: `not_found` (absent, access denied, not a capture node).
  [[nodiscard]] static Result<VideoDevice> open(const std::string& node);
  ~VideoDevice();
  VideoDevice(VideoDevice&&) noexcept = default;
  VideoDevice& operator=(VideoDevice&&) noexcept = default;
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const VideoCapability& capability() const { return capability_; }
  /// Lists formats and discrete sizes. For a range of sizes, the largest size is listed. If a driver lists no sizes,
  /// very large and very small sizes are tried; the result contains the sizes that the driver substitutes and the
  /// present size. `also`: a size that is also tried in every format, for a driver that lists only a range.
  [[nodiscard]] std::vector<VideoMode> modes(const std::optional<cv::Size>& also = {}) const;
  /// Sets the mode. Returns the layout with the driver's row length. Error: `not_found` (busy, or the driver set a
  /// different mode).
  [[nodiscard]] Result<VideoLayout> set_format(VideoLayout layout);
  /// Fails if the present format differs from the format of the layout.
  [[nodiscard]] Result<void> check_format(const VideoLayout& layout) const;
  /// Returns the frame rate in Hz; 0: not reported. set_frame_rate(): 0.1 to 10 000 Hz, otherwise `invalid_input`.
  [[nodiscard]] double frame_rate_hz() const;
  [[nodiscard]] Result<void> set_frame_rate(double frame_rate_hz);

  /// Requests, maps and queues buffers and starts streaming. Error: `not_found` (busy); all buffers are then released.
  [[nodiscard]] Result<void> start(unsigned buffers);
  /// Stops and unmaps. No effect if stopped.
  void stop();
  /// Passes the next filled buffer to `use` and queues it again; false if no buffer is ready. Error: `disconnected`.
  [[nodiscard]] Result<bool> take(const std::function<void(const VideoBuffer&)>& use);

  /// Calls ioctl() and repeats it when a signal interrupts it. Returns errno; 0 for success.
  [[nodiscard]] int call(unsigned long request, void* argument) const;

 private:
  /// Memory shared with the driver.
  class Mapping {
   public:
    Mapping(void* data, std::size_t length) : data_(data), length_(length) {}
    ~Mapping();
    Mapping(Mapping&& other) noexcept;
    Mapping& operator=(Mapping&&) = delete;
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    [[nodiscard]] std::span<const std::uint8_t> bytes() const {
      return {static_cast<const std::uint8_t*>(data_), length_};
    }

   private:
    void* data_;
    std::size_t length_;
  };

  VideoDevice(Descriptor fd, VideoCapability capability);
  [[nodiscard]] Result<void> map_and_queue(unsigned index);
  /// Returns the sizes of a format that the driver lists.
  [[nodiscard]] std::vector<VideoMode> listed_sizes(std::uint32_t fourcc) const;
  /// Returns the sizes found by trying.
  [[nodiscard]] std::vector<VideoMode> tried_sizes(std::uint32_t fourcc) const;
  /// Returns the size that the driver would use for `wanted`; empty if the query fails or the driver would use a
  /// different format.
  [[nodiscard]] std::optional<VideoMode> tried(VideoMode wanted) const;

  Descriptor fd_;
  VideoCapability capability_;
  std::vector<Mapping> buffers_;
  bool requested_ = false;
  std::size_t image_bytes_ = 0;  ///< size of a frame of the format, as the driver reports it; 0: unknown
};

/// Returns the error of an ioctl: `disconnected` for a device that is gone, otherwise `otherwise`.
[[nodiscard]] Error video_error(int error_number, const std::string& doing, ErrorCode otherwise);

}  // namespace todbench
