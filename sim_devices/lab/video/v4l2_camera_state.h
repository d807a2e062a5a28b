// SPDX-License-Identifier: GPL-3.0-or-later
// State of an emulated V4L2 camera, shared by camera thread and driver. Private to thread and driver.
#pragma once

#include <sys/ioctl.h>
// after sys/ioctl.h
#include <linux/videodev2.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "sim_devices/lab/video/v4l2_camera.h"

// As declared in umockdev.h.
struct _UMockdevIoctlBase;
struct _UMockdevIoctlClient;
using UMockdevIoctlBase = _UMockdevIoctlBase;
using UMockdevIoctlClient = _UMockdevIoctlClient;

namespace todbench {

/// A driver in user space. `mutex` guards all members below it.
struct EmulatedV4l2Camera::State {
  VideoCameraConfig config;
  Exposure exposure;
  VideoWireFormat format;
  VideoDriverQuirks quirks;
  int number = 0;
  int file = -1;  ///< the node, which contains the buffers
  std::shared_ptr<MockSystem> system;
  UMockdevIoctlBase* handler = nullptr;

  std::mutex mutex;
  std::condition_variable_any changed;
  bool unplugged = false;
  UMockdevIoctlClient* owner = nullptr;  ///< client that has buffers; never dereferenced
  cv::Size size;
  double frame_rate_hz = 50;
  std::uint32_t buffers = 0;
  std::uint32_t buffer_bytes = 0;
  bool streaming = false;
  std::deque<std::uint32_t> queued;  ///< indices of the empty buffers, in the order of use
  std::deque<v4l2_buffer> done;      ///< filled buffers that wait for DQBUF
  std::uint32_t sequence = 0;
  std::uint64_t exposures = 0, failed = 0, corrections = 0, last_correction = 0;
  int frozen_frames = 0;
  unsigned to_lose = 0;  ///< number of next exposures that are not sent
  std::optional<std::uint32_t> truncated, shortened, misstated, misplaced;
  cv::Mat1w last;
  std::jthread camera;

  ~State();

  [[nodiscard]] std::uint32_t image_bytes() const {
    return static_cast<std::uint32_t>(size.area() * format.bytes_per_pixel() + size.height * quirks.row_padding_bytes);
  }

  void expose(const std::stop_token& stop);
  [[nodiscard]] cv::Mat1w picture(std::uint64_t index);
  void deliver(const cv::Mat1w& counts, std::uint64_t index);
  void end_stream();

  // One method per ioctl; each returns an errno. Called with the mutex held.
  int query_capability(v4l2_capability& out) const;
  int enumerate_format(v4l2_fmtdesc& out) const;
  int enumerate_size(v4l2_frmsizeenum& out) const;
  int get_format(v4l2_format& out) const;
  int try_format(v4l2_format& out, cv::Size& chosen) const;
  int made_of(v4l2_format& out);
  int set_format(v4l2_format& out);
  int get_parameters(v4l2_streamparm& out) const;
  int set_parameters(v4l2_streamparm& out);
  int request_buffers(v4l2_requestbuffers& out, UMockdevIoctlClient* client);
  int query_buffer(v4l2_buffer& out) const;
  int queue_buffer(const v4l2_buffer& in);
  int dequeue_buffer(v4l2_buffer& out, std::unique_lock<std::mutex>& lock);
  int switch_stream(bool on);
  int query_control(v4l2_query_ext_ctrl& out) const;
  int set_control(const v4l2_control& in);

  [[nodiscard]] int serve(UMockdevIoctlClient* client, std::unique_lock<std::mutex>& lock);
  static int on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* state);
  static void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* state);
};

}  // namespace todbench
