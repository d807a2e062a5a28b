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

#include "acquisition/core/result.h"
#include "acquisition/v4l2/video_layout.h"

namespace todbench {

/// A file descriptor, closed at the end.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor();
  FileDescriptor(FileDescriptor&& other) noexcept;
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool valid() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// What a driver says of a node.
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
  bool damaged = false;      ///< V4L2_BUF_FLAG_ERROR, or nothing in it
  bool oversized = false;    ///< states more bytes than its buffer or the format has
};

/// An open node. Errors of every method: `disconnected` when the device has gone (ENODEV), otherwise as said. Not
/// thread-safe: the source serialises.
class VideoDevice {
 public:
  /// `not_found`: absent, access denied, not a capture node.
  [[nodiscard]] static Result<VideoDevice> open(const std::string& node);
  ~VideoDevice();
  VideoDevice(VideoDevice&&) noexcept = default;
  VideoDevice& operator=(VideoDevice&&) noexcept = default;
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const VideoCapability& capability() const { return capability_; }
  /// Formats and discrete sizes; a range of sizes counts as its largest. Of a driver that does not list sizes, those
  /// that it makes of very large and very small ones, and the present one.
  [[nodiscard]] std::vector<VideoMode> modes() const;
  /// Sets the mode; fills in what the driver made of the rows. `not_found`: busy, or another mode was set.
  [[nodiscard]] Result<VideoLayout> set_format(VideoLayout layout);
  /// The present format is still that of the layout.
  [[nodiscard]] Result<void> check_format(const VideoLayout& layout) const;
  /// Frames per second; 0 when the driver does not say.
  [[nodiscard]] double frame_rate_hz() const;
  [[nodiscard]] Result<void> set_frame_rate(double frame_rate_hz);

  /// Requests, maps and queues buffers and starts. `not_found`: busy. Leaves nothing behind when it fails.
  [[nodiscard]] Result<void> start(unsigned buffers);
  /// Stops and unmaps; harmless when stopped.
  void stop();
  /// Hands the next finished buffer to `use` and queues it again. False: there is none yet.
  [[nodiscard]] Result<bool> take(const std::function<void(const VideoBuffer&)>& use);

  /// ioctl() that tries again when a signal interrupts. Returns errno, 0 for success.
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

  VideoDevice(FileDescriptor fd, VideoCapability capability);
  [[nodiscard]] Result<void> map_and_queue(unsigned index);
  /// Sizes of a format that the driver lists.
  [[nodiscard]] std::vector<VideoMode> listed_sizes(std::uint32_t fourcc) const;
  /// Sizes that are found by trying.
  [[nodiscard]] std::vector<VideoMode> tried_sizes(std::uint32_t fourcc) const;
  /// What the driver would make of a size; nothing where it cannot be asked or makes another format of it.
  [[nodiscard]] std::optional<VideoMode> tried(VideoMode wanted) const;

  FileDescriptor fd_;
  VideoCapability capability_;
  std::vector<Mapping> buffers_;
  bool requested_ = false;
  std::size_t image_bytes_ = 0;  ///< of the format, as the driver says; 0: it does not
};

/// The failure of an ioctl: `disconnected` for a device that has gone, `busy` and others `otherwise`.
[[nodiscard]] Error video_error(int error_number, const std::string& doing, ErrorCode otherwise);

}  // namespace todbench
