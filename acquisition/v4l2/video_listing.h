// SPDX-License-Identifier: GPL-3.0-or-later
// Video4Linux cameras: their identity, arrival and removal, through udev. Private to the V4L2 back end except
// VideoWatch.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/v4l2/video_layout.h"

namespace todbench {

/// A capture node and the identity of its device.
struct VideoNode {
  std::string id;           ///< "v4l2:VENDOR-MODEL-SERIAL"
  std::string node;         ///< "/dev/video2": present node, never part of the identity
  std::string sys_path;     ///< path of the video device in sysfs
  std::string device_path;  ///< path of the device that contains it
  std::string vendor, model, serial, firmware;
  std::string port;  ///< port of a USB device, "1-2.3"
  std::uint16_t usb_vendor = 0, usb_product = 0;
  std::string driver;

  [[nodiscard]] VideoFamily family() const { return video_family(usb_vendor, usb_product); }
};

/// Returns "v4l2:VENDOR-MODEL-SERIAL" in letters, digits, '.', '_' (other characters become '_'). A camera without a
/// serial number is identified by its port: "v4l2:VENDOR-MODEL-at_1_2.3".
[[nodiscard]] std::string video_id(const VideoNode& node);

/// Assigns a unique id to every node. For cameras of one kind with equal serial numbers, the id also contains the port,
/// "v4l2:VENDOR-MODEL-SERIAL-at_1_2.3", because the order of the nodes changes when the cameras are plugged in again.
/// If ids are still equal, the nodes are numbered in the order of the list: the second ends in ".2".
void tell_apart(std::vector<VideoNode>& nodes);

/// All nodes that capture with streaming. Nodes that cannot be opened are listed in `unreadable`.
struct VideoListing {
  std::vector<VideoNode> nodes;
  std::vector<std::string> unreadable;  ///< one sentence each
};
/// Lists the nodes with the identity of their devices. Error: `io` (udev does not answer).
[[nodiscard]] Result<VideoListing> list_video_nodes();

/// Arrival or removal of a video device.
struct VideoEvent {
  enum class Kind { arrived, removed };
  Kind kind = Kind::arrived;
  std::string node;      ///< "/dev/video2"
  std::string sys_path;  ///< distinguishes the device from a different device that gets the same node later
};

/// Arrivals and removals of video devices since its creation. One thread at a time. Error of create(): `io`.
class VideoWatch {
 public:
  [[nodiscard]] static Result<VideoWatch> create();
  ~VideoWatch();
  VideoWatch(VideoWatch&&) noexcept;
  VideoWatch& operator=(VideoWatch&&) noexcept;

  /// Descriptor for poll(), readable when an event is pending.
  [[nodiscard]] int fd() const;
  /// Returns the next event; empty if none arrived in time.
  [[nodiscard]] std::optional<VideoEvent> next(std::chrono::milliseconds timeout);

 private:
  struct State;
  explicit VideoWatch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
