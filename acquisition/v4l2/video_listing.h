// Which cameras the kernel has, who they are, and when they come and go, by udev. Private to the V4L2 back end but for
// VideoWatch.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "acquisition/v4l2/video_layout.h"

namespace todbench {

/// A capture node and the identity of the device behind it.
struct VideoNode {
  std::string id;           ///< "v4l2:VENDOR-MODEL-SERIAL"
  std::string node;         ///< "/dev/video2": where it is now, never part of the identity
  std::string sys_path;     ///< of the video device
  std::string device_path;  ///< of the device that it is a part of
  std::string vendor, model, serial, firmware;
  std::string port;  ///< of a USB device, "1-2.3"
  std::uint16_t usb_vendor = 0, usb_product = 0;
  std::string driver;

  [[nodiscard]] VideoFamily family() const { return video_family(usb_vendor, usb_product); }
};

/// "v4l2:VENDOR-MODEL-SERIAL" in letters, digits, '.', '_' (anything else becomes '_'); a camera without a serial is
/// told by where it is plugged in: "v4l2:VENDOR-MODEL-at_1_2.3".
[[nodiscard]] std::string video_id(const VideoNode& node);

/// Gives every node an id of its own. Cameras of one kind with one serial number are told apart by where they are
/// plugged in too, "v4l2:VENDOR-MODEL-SERIAL-at_1_2.3": by the order of their nodes one would be taken for the other
/// when they are plugged in again. A second capture node of one device is told by that order, ".2".
void tell_apart(std::vector<VideoNode>& nodes);

/// Every node that captures with streaming; nodes that cannot be opened are named in `unreadable`.
struct VideoListing {
  std::vector<VideoNode> nodes;
  std::vector<std::string> unreadable;  ///< one sentence each
};
[[nodiscard]] Result<VideoListing> list_video_nodes();

/// What happened to a video device.
struct VideoEvent {
  enum class Kind { arrived, removed };
  Kind kind = Kind::arrived;
  std::string node;      ///< "/dev/video2"
  std::string sys_path;  ///< tells it from another device that gets the same node later
};

/// Arrivals and removals since it was created. One thread at a time.
class VideoWatch {
 public:
  [[nodiscard]] static Result<VideoWatch> create();
  ~VideoWatch();
  VideoWatch(VideoWatch&&) noexcept;
  VideoWatch& operator=(VideoWatch&&) noexcept;

  /// Readable when an event waits; for poll().
  [[nodiscard]] int fd() const;
  /// The next event; nothing when none came in time.
  [[nodiscard]] std::optional<VideoEvent> next(std::chrono::milliseconds timeout);

 private:
  struct State;
  explicit VideoWatch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
