// SPDX-License-Identifier: GPL-3.0-or-later
// The camera: device node, clock and exposures. The ioctls are in v4l2_driver.cpp.
#include "sim_devices/lab/video/v4l2_camera.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "sim_devices/lab/video/v4l2_camera_state.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Counts the nodes of a process, so that every emulated camera has its own.
std::atomic<int> next_node_number{0};

std::string usb_path(int number) {
  return "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number + 1);
}
std::string video_path(int number) {
  return usb_path(number) + "/1-" + std::to_string(number + 1) + ":1.0/video4linux/video" + std::to_string(number);
}

std::string hexadecimal(unsigned value) {
  return fmt::format("{:04x}", value);
}

/// USB device and its video node in sysfs. "=00" makes the node a regular file.
std::string description(const VideoCameraConfig& config, int number) {
  const UsbIdentity usb = usb_identity(config.kind);
  const std::string node = "video" + std::to_string(number);
  return "P: " + usb_path(number) +
         "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=" + hexadecimal(usb.vendor) +
         "\\n\nA: idProduct=" + hexadecimal(usb.product) +
         "\\n\nA: bcdDevice=0100\\n\nA: manufacturer=" + config.vendor + "\\n\nA: product=" + config.model +
         "\\n\nA: serial=" + config.serial + "\\n\n\nP: " + video_path(number) + "\nN: " + node +
         "=00\nE: DEVNAME=/dev/" + node +
         "\nE: SUBSYSTEM=video4linux\nE: MAJOR=81\nE: MINOR=" + std::to_string(number) +
         "\nA: index=0\\n\nA: name=" + config.model + "\\n\n";
}

/// Adds padding after each row that would be near full scale as pixels.
std::vector<std::uint8_t> padded(std::vector<std::uint8_t> frame, std::size_t rows, std::size_t padding) {
  if (padding == 0) return frame;
  const auto row_bytes = static_cast<std::ptrdiff_t>(frame.size() / rows);
  std::vector<std::uint8_t> out;
  for (auto row = frame.begin(); row != frame.end(); row += row_bytes) {
    out.insert(out.end(), row, row + row_bytes);
    out.insert(out.end(), padding, std::uint8_t{0x3E});
  }
  return out;
}

}  // namespace

EmulatedV4l2Camera::State::~State() {
  camera = {};
  if (handler != nullptr) {
    umockdev_testbed_detach_ioctl(system->testbed(), ("/dev/video" + std::to_string(number)).c_str(), nullptr);
    g_object_unref(handler);
  }
  if (file >= 0) ::close(file);
}

cv::Mat1w EmulatedV4l2Camera::State::picture(std::uint64_t index) {
  cv::Mat1w counts;
  try {
    counts = exposure(index);
  } catch (...) {
    // No exception may end the camera's thread; the owner reads the count.
    counts = {};
  }
  if (counts.cols == config.width && counts.rows == config.height) return counts;
  const std::lock_guard lock(mutex);
  ++failed;
  return cv::Mat1w::zeros(config.height, config.width);
}

void EmulatedV4l2Camera::State::deliver(const cv::Mat1w& counts, std::uint64_t index) {
  const std::uint32_t number_in_stream = sequence++;
  if (to_lose > 0) {
    --to_lose;
    return;
  }
  if (queued.empty()) return;
  v4l2_buffer buffer{};
  buffer.index = queued.front();
  queued.pop_front();
  const auto bytes = padded(wire_frame(config, counts, size,
                                       {.exposure = index,
                                        .correcting = frozen_frames > 0,
                                        .last_correction = corrections > 0 ? last_correction : 0}),
                            static_cast<std::size_t>(size.height), static_cast<std::size_t>(quirks.row_padding_bytes));
  static_cast<void>(!::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(buffer.index) * buffer_bytes));
  const auto time_us = static_cast<std::int64_t>(std::llround(static_cast<double>(index + 1) * 1e6 / frame_rate_hz));
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.bytesused = static_cast<__u32>(bytes.size());
  buffer.length = buffer_bytes;
  buffer.m.offset = buffer.index * buffer_bytes;
  buffer.sequence = number_in_stream;
  buffer.field = V4L2_FIELD_NONE;
  buffer.flags = V4L2_BUF_FLAG_DONE;
  buffer.timestamp = {.tv_sec = time_us / 1'000'000, .tv_usec = time_us % 1'000'000};
  if (arrives_short(config, index)) buffer.bytesused /= 2;
  if (shortened) buffer.bytesused = std::min(buffer.bytesused, *std::exchange(shortened, std::nullopt));
  if (truncated) {
    buffer.bytesused = std::min(buffer.bytesused, *truncated);
    buffer.flags |= V4L2_BUF_FLAG_ERROR;
    truncated.reset();
  }
  buffer.bytesused = std::exchange(misstated, std::nullopt).value_or(buffer.bytesused);
  buffer.index = std::exchange(misplaced, std::nullopt).value_or(buffer.index);
  done.push_back(buffer);
}

void EmulatedV4l2Camera::State::expose(const std::stop_token& stop) {
  auto due = Clock::now();
  while (!stop.stop_requested()) {
    std::uint64_t index = 0;
    bool frozen = false;
    {
      std::unique_lock lock(mutex);
      if (!changed.wait(lock, stop, [&] { return streaming; })) return;
      const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / frame_rate_hz));
      due = std::max(due + period, Clock::now());
      if (changed.wait_until(lock, stop, due, [&] { return !streaming; })) continue;
      if (stop.stop_requested()) return;
      index = exposures++;
      frozen = frozen_frames > 0 && !last.empty();
    }
    // The scene is rendered without the lock: a client must not wait for it.
    const cv::Mat1w counts = frozen ? last : picture(index);
    {
      const std::lock_guard lock(mutex);
      last = counts;
      if (streaming) deliver(counts, index);
      if (frozen_frames > 0) --frozen_frames;
    }
    changed.notify_all();
  }
}

void EmulatedV4l2Camera::State::end_stream() {
  streaming = false;
  queued.clear();
  done.clear();
}

EmulatedV4l2Camera::EmulatedV4l2Camera(std::unique_ptr<State> state) : state_(std::move(state)) {}

EmulatedV4l2Camera::~EmulatedV4l2Camera() {
  unplug();
}

Result<std::unique_ptr<EmulatedV4l2Camera>> EmulatedV4l2Camera::start(std::shared_ptr<MockSystem> system,
                                                                      VideoCameraConfig config, Exposure exposure,
                                                                      VideoDriverQuirks quirks) {
  TODBENCH_TRY_VOID(validate(config));
  if (!exposure) return fail(ErrorCode::invalid_input, "emulated video camera: the exposure function is missing");
  auto state = std::make_unique<State>();
  state->config = std::move(config);
  state->exposure = std::move(exposure);
  state->format = wire_format(state->config);
  state->quirks = std::move(quirks);
  state->size = state->format.sizes.front();
  state->frame_rate_hz = state->config.frame_rate_hz;
  state->number = next_node_number++;
  state->system = std::move(system);
  const std::string node = "/dev/video" + std::to_string(state->number);
  if (const auto added = state->system->add(description(state->config, state->number)); !added) {
    return tl::unexpected(added.error());
  }
  const std::string file = state->system->folder() + node;
  state->file = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (state->file < 0) return fail(ErrorCode::io, "emulated video camera: " + file + " cannot be opened");
  state->handler = umockdev_ioctl_base_new();
  g_signal_connect(state->handler, "handle-ioctl", G_CALLBACK(&State::on_ioctl), state.get());
  g_signal_connect(state->handler, "client-vanished", G_CALLBACK(&State::on_vanished), state.get());
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(state->system->testbed(), node.c_str(), state->handler, &error) == 0) {
    const std::string message = error != nullptr ? error->message : "unknown error";
    g_clear_error(&error);
    return fail(ErrorCode::internal, "emulated video camera: " + message);
  }
  state->camera = std::jthread([raw = state.get()](const std::stop_token& stop) { raw->expose(stop); });
  return std::unique_ptr<EmulatedV4l2Camera>(new EmulatedV4l2Camera(std::move(state)));
}

std::string EmulatedV4l2Camera::node() const {
  return "/dev/video" + std::to_string(state_->number);
}
const VideoCameraConfig& EmulatedV4l2Camera::config() const {
  return state_->config;
}
std::uint64_t EmulatedV4l2Camera::exposures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->exposures;
}
std::uint64_t EmulatedV4l2Camera::failed_exposures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->failed;
}
std::uint64_t EmulatedV4l2Camera::nonuniformity_corrections() const {
  const std::lock_guard lock(state_->mutex);
  return state_->corrections;
}

void EmulatedV4l2Camera::unplug() {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->unplugged) return;
    state_->unplugged = true;
    state_->end_stream();
  }
  state_->changed.notify_all();
  const std::string path = "/sys" + video_path(state_->number);
  state_->system->announce(path, "remove");
  state_->system->remove(path);
}

void EmulatedV4l2Camera::lose_exposures(unsigned count) {
  const std::lock_guard lock(state_->mutex);
  state_->to_lose += count;
}

void EmulatedV4l2Camera::truncate_next_frame(std::uint32_t bytes) {
  const std::lock_guard lock(state_->mutex);
  state_->truncated = bytes;
}

void EmulatedV4l2Camera::shorten_next_frame(std::uint32_t bytes) {
  const std::lock_guard lock(state_->mutex);
  state_->shortened = bytes;
}

void EmulatedV4l2Camera::misstate_next_frame(std::uint32_t bytes) {
  const std::lock_guard lock(state_->mutex);
  state_->misstated = bytes;
}

void EmulatedV4l2Camera::misplace_next_frame(std::uint32_t index) {
  const std::lock_guard lock(state_->mutex);
  state_->misplaced = index;
}

void EmulatedV4l2Camera::restart_sequence(std::uint32_t number) {
  const std::lock_guard lock(state_->mutex);
  state_->sequence = number;
}

}  // namespace todbench
