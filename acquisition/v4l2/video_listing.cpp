// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/video_listing.h"

#include <libudev.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>

#include "acquisition/core/camera_id.h"
#include "acquisition/v4l2/video_device.h"

namespace todbench {
namespace {

struct Unref {
  void operator()(udev* u) const { udev_unref(u); }
  void operator()(udev_enumerate* e) const { udev_enumerate_unref(e); }
  void operator()(udev_device* d) const { udev_device_unref(d); }
  void operator()(udev_monitor* m) const { udev_monitor_unref(m); }
};
template <typename T>
using Owned = std::unique_ptr<T, Unref>;

std::string text_or_empty(const char* text) {
  return text != nullptr ? text : "";
}

/// A sysfs attribute without surrounding blanks.
std::string attribute(udev_device* device, const char* name) {
  std::string text = text_or_empty(device != nullptr ? udev_device_get_sysattr_value(device, name) : nullptr);
  const auto visible = [](unsigned char c) { return std::isgraph(c) != 0; };
  text.erase(std::find_if(text.rbegin(), text.rend(), visible).base(), text.end());
  text.erase(text.begin(), std::find_if(text.begin(), text.end(), visible));
  return text;
}

std::uint16_t hexadecimal(const std::string& text) {
  return static_cast<std::uint16_t>(std::strtoul(text.c_str(), nullptr, 16));
}

std::string first_of(std::string preferred, std::string fallback) {
  return preferred.empty() ? std::move(fallback) : std::move(preferred);
}

/// Names come from the USB device's own strings. udev's database is not needed, so a system without udevd works too.
VideoNode described(udev_device* video, const VideoCapability& capability) {
  VideoNode node;
  node.node = text_or_empty(udev_device_get_devnode(video));
  node.sys_path = text_or_empty(udev_device_get_syspath(video));
  node.driver = capability.driver;
  udev_device* usb = udev_device_get_parent_with_subsystem_devtype(video, "usb", "usb_device");
  if (usb != nullptr) {
    node.usb_vendor = hexadecimal(attribute(usb, "idVendor"));
    node.usb_product = hexadecimal(attribute(usb, "idProduct"));
    node.vendor = first_of(attribute(usb, "manufacturer"), attribute(usb, "idVendor"));
    node.model = first_of(attribute(usb, "product"), attribute(usb, "idProduct"));
    node.serial = attribute(usb, "serial");
    node.firmware = attribute(usb, "bcdDevice");
    node.port = text_or_empty(udev_device_get_sysname(usb));
    node.device_path = text_or_empty(udev_device_get_syspath(usb));
  } else {
    node.vendor = capability.driver;
    node.model = capability.card;
    node.port = capability.bus;
    node.device_path = capability.bus.empty() ? node.sys_path : capability.bus;
  }
  node.id = video_id(node);
  return node;
}

}  // namespace

std::string video_id(const VideoNode& node) {
  const std::string told_by = node.serial.empty() ? "at_" + node.port : node.serial;
  return camera_id(camera_scheme::v4l2, {node.vendor, node.model, told_by});
}

void tell_apart(std::vector<VideoNode>& nodes) {
  std::vector<std::string> ids;
  for (const VideoNode& node : nodes) {
    const bool has_double = std::any_of(nodes.begin(), nodes.end(), [&](const VideoNode& other) {
      return other.device_path != node.device_path && video_id(other) == video_id(node);
    });
    ids.push_back(has_double && !node.serial.empty()
                      ? camera_id(camera_scheme::v4l2, {node.vendor, node.model, node.serial, "at_" + node.port})
                      : video_id(node));
  }
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto before = std::count(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(k), ids[k]);
    nodes[k].id = before > 0 ? ids[k] + "." + std::to_string(before + 1) : ids[k];
  }
}

Result<VideoListing> list_video_nodes() {
  const Owned<udev> context(udev_new());
  const Owned<udev_enumerate> found(context ? udev_enumerate_new(context.get()) : nullptr);
  if (!found) return fail(ErrorCode::io, "udev cannot list the video devices");
  udev_enumerate_add_match_subsystem(found.get(), "video4linux");
  udev_enumerate_scan_devices(found.get());
  VideoListing listing;
  for (udev_list_entry* entry = udev_enumerate_get_list_entry(found.get()); entry != nullptr;
       entry = udev_list_entry_get_next(entry)) {
    const Owned<udev_device> video(udev_device_new_from_syspath(context.get(), udev_list_entry_get_name(entry)));
    const char* path = video ? udev_device_get_devnode(video.get()) : nullptr;
    if (path == nullptr) continue;
    const auto device = VideoDevice::open(path);
    if (!device) {
      listing.unreadable.push_back(device.error().message);
      continue;
    }
    if (!device->capability().captures) continue;
    listing.nodes.push_back(described(video.get(), device->capability()));
  }
  tell_apart(listing.nodes);
  return listing;
}

struct VideoWatch::State {
  Owned<udev> context;
  Owned<udev_monitor> monitor;
};

VideoWatch::VideoWatch(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoWatch::~VideoWatch() = default;
VideoWatch::VideoWatch(VideoWatch&&) noexcept = default;
VideoWatch& VideoWatch::operator=(VideoWatch&&) noexcept = default;

Result<VideoWatch> VideoWatch::create() {
  // udevd reports a device when its node has its permissions; without udevd only the kernel reports it.
  const bool has_daemon = ::access("/run/udev/control", F_OK) == 0;
  auto state = std::make_unique<State>();
  state->context.reset(udev_new());
  if (state->context) {
    state->monitor.reset(udev_monitor_new_from_netlink(state->context.get(), has_daemon ? "udev" : "kernel"));
  }
  if (!state->monitor ||
      udev_monitor_filter_add_match_subsystem_devtype(state->monitor.get(), "video4linux", nullptr) < 0 ||
      udev_monitor_enable_receiving(state->monitor.get()) < 0) {
    return fail(ErrorCode::io, "udev cannot report connected and disconnected devices");
  }
  return VideoWatch(std::move(state));
}

int VideoWatch::fd() const {
  return udev_monitor_get_fd(state_->monitor.get());
}

std::optional<VideoEvent> VideoWatch::next(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    while (const Owned<udev_device> device{udev_monitor_receive_device(state_->monitor.get())}) {
      const std::string action = text_or_empty(udev_device_get_action(device.get()));
      if (action != "add" && action != "remove") continue;
      return VideoEvent{.kind = action == "add" ? VideoEvent::Kind::arrived : VideoEvent::Kind::removed,
                        .node = text_or_empty(udev_device_get_devnode(device.get())),
                        .sys_path = text_or_empty(udev_device_get_syspath(device.get()))};
    }
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    if (left <= 0) return std::nullopt;
    pollfd ready{.fd = fd(), .events = POLLIN, .revents = 0};
    if (::poll(&ready, 1, static_cast<int>(std::min<long long>(left, 1000))) < 0 && errno != EINTR) return std::nullopt;
  }
}

}  // namespace todbench
