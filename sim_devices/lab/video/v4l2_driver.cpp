// SPDX-License-Identifier: GPL-3.0-or-later
// Driver of an emulated V4L2 camera: one method per ioctl, with the answers of uvcvideo.
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "sim_devices/lab/video/v4l2_camera_state.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t most_buffers = 32;
/// poll() on the node is always ready, so a DQBUF waits a little, and a client does not spin.
constexpr auto dequeue_patience = 10ms;
constexpr std::uint32_t nuc_button = V4L2_CID_PRIVATE_BASE;
constexpr std::size_t page = 4096;

template <std::size_t N>
void put_text(__u8 (&field)[N], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), N - 1));
}

}  // namespace

int EmulatedV4l2Camera::State::query_capability(v4l2_capability& out) const {
  out = {};
  put_text(out.driver, quirks.driver);
  put_text(out.card, config.model);
  put_text(out.bus_info, "usb-0000:00:14.0-" + std::to_string(number + 1));
  out.version = 0x00060100;
  out.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  out.capabilities = out.device_caps | V4L2_CAP_DEVICE_CAPS;
  return 0;
}

int EmulatedV4l2Camera::State::enumerate_format(v4l2_fmtdesc& out) const {
  if (out.index != 0 || out.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return EINVAL;
  out.flags = 0;
  out.pixelformat = format.fourcc();
  return 0;
}

int EmulatedV4l2Camera::State::enumerate_size(v4l2_frmsizeenum& out) const {
  using Sizes = VideoDriverQuirks::Sizes;
  if (quirks.sizes == Sizes::unlisted) return ENOTTY;
  if (out.pixel_format != format.fourcc() || out.index >= format.sizes.size()) return EINVAL;
  if (quirks.sizes != Sizes::listed) {
    if (out.index != 0) return EINVAL;
    const auto& largest = format.sizes.back();
    const bool continuous = quirks.sizes == Sizes::continuous;
    out.type = continuous ? V4L2_FRMSIZE_TYPE_CONTINUOUS : V4L2_FRMSIZE_TYPE_STEPWISE;
    out.stepwise = {.min_width = 2,
                    .max_width = static_cast<__u32>(largest.width),
                    .step_width = continuous ? 1U : 2U,
                    .min_height = 2,
                    .max_height = static_cast<__u32>(largest.height),
                    .step_height = continuous ? 1U : 2U};
    return 0;
  }
  out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
  out.discrete = {.width = static_cast<__u32>(format.sizes[out.index].width),
                  .height = static_cast<__u32>(format.sizes[out.index].height)};
  return 0;
}

int EmulatedV4l2Camera::State::get_format(v4l2_format& out) const {
  if (out.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return EINVAL;
  out.fmt.pix = {};
  out.fmt.pix.width = static_cast<__u32>(size.width);
  out.fmt.pix.height = static_cast<__u32>(size.height);
  out.fmt.pix.pixelformat = format.fourcc();
  out.fmt.pix.field = V4L2_FIELD_NONE;
  out.fmt.pix.bytesperline = static_cast<__u32>(size.width * format.bytes_per_pixel());
  if (quirks.states_row_bytes) out.fmt.pix.bytesperline += static_cast<__u32>(quirks.row_padding_bytes);
  out.fmt.pix.sizeimage = image_bytes();
  out.fmt.pix.colorspace = V4L2_COLORSPACE_SRGB;
  return 0;
}

int EmulatedV4l2Camera::State::try_format(v4l2_format& out, cv::Size& chosen) const {
  if (out.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return EINVAL;
  // As uvcvideo: an unknown size is replaced by an offered one.
  chosen =
      out.fmt.pix.width > static_cast<__u32>(format.sizes.back().width) ? format.sizes.back() : format.sizes.front();
  for (const auto& s : format.sizes) {
    if (static_cast<__u32>(s.width) == out.fmt.pix.width && static_cast<__u32>(s.height) == out.fmt.pix.height)
      chosen = s;
  }
  return 0;
}

int EmulatedV4l2Camera::State::made_of(v4l2_format& out) {
  const cv::Size present = size;
  if (const int error = try_format(out, size); error != 0) return error;
  const int error = get_format(out);
  size = present;
  return error;
}

int EmulatedV4l2Camera::State::set_format(v4l2_format& out) {
  if (buffers > 0) return EBUSY;
  cv::Size chosen;
  if (const int error = try_format(out, chosen); error != 0) return error;
  size = chosen;
  return get_format(out);
}

int EmulatedV4l2Camera::State::get_parameters(v4l2_streamparm& out) const {
  if (out.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return EINVAL;
  out.parm.capture = {};
  out.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  out.parm.capture.timeperframe = {.numerator = 1000,
                                   .denominator = static_cast<__u32>(std::lround(1000 * frame_rate_hz))};
  return 0;
}

int EmulatedV4l2Camera::State::set_parameters(v4l2_streamparm& out) {
  if (buffers > 0) return EBUSY;
  const v4l2_fract& interval = out.parm.capture.timeperframe;
  if (interval.numerator > 0 && interval.denominator > 0) {
    frame_rate_hz = std::clamp(static_cast<double>(interval.denominator) / interval.numerator, 0.1, 1000.0);
  }
  return get_parameters(out);
}

int EmulatedV4l2Camera::State::request_buffers(v4l2_requestbuffers& out, UMockdevIoctlClient* client) {
  if (out.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || out.memory != V4L2_MEMORY_MMAP) return EINVAL;
  if (owner != nullptr && owner != client) return EBUSY;
  if (streaming) return EBUSY;
  buffers = std::min(out.count, most_buffers);
  out.count = buffers;
  end_stream();
  owner = buffers > 0 ? client : nullptr;
  buffer_bytes = static_cast<std::uint32_t>((image_bytes() + page - 1) / page * page);
  if (buffers > 0 && ::ftruncate(file, static_cast<off_t>(buffers) * buffer_bytes) != 0) return ENOMEM;
  return 0;
}

int EmulatedV4l2Camera::State::query_buffer(v4l2_buffer& out) const {
  if (out.index >= buffers || out.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return EINVAL;
  out.memory = V4L2_MEMORY_MMAP;
  out.length = buffer_bytes;
  out.m.offset = out.index * buffer_bytes;
  out.flags = 0;
  return 0;
}

int EmulatedV4l2Camera::State::queue_buffer(const v4l2_buffer& in) {
  const auto pending = [&](const auto& list, auto index_of) {
    return std::any_of(list.begin(), list.end(), [&](const auto& b) { return index_of(b) == in.index; });
  };
  if (in.index >= buffers || in.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || in.memory != V4L2_MEMORY_MMAP) return EINVAL;
  if (pending(queued, [](std::uint32_t b) { return b; }) ||
      pending(done, [](const v4l2_buffer& b) { return b.index; })) {
    return EINVAL;
  }
  queued.push_back(in.index);
  return 0;
}

int EmulatedV4l2Camera::State::dequeue_buffer(v4l2_buffer& out, std::unique_lock<std::mutex>& lock) {
  if (!streaming) return EINVAL;
  changed.wait_for(lock, dequeue_patience, [&] { return !done.empty() || !streaming || unplugged; });
  if (unplugged) return ENODEV;
  if (!streaming) return EINVAL;
  if (done.empty()) return EAGAIN;
  out = done.front();
  done.pop_front();
  return 0;
}

int EmulatedV4l2Camera::State::switch_stream(bool on) {
  if (!on) {
    end_stream();
    return 0;
  }
  if (buffers == 0) return EINVAL;
  if (!streaming) sequence = 0;
  streaming = true;
  changed.notify_all();
  return 0;
}

int EmulatedV4l2Camera::State::query_control(v4l2_query_ext_ctrl& out) const {
  const bool next = (out.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  const std::uint32_t id = out.id & V4L2_CTRL_ID_MASK;
  if (next ? id >= nuc_button : id != nuc_button) return EINVAL;
  out = {};
  out.id = nuc_button;
  out.type = V4L2_CTRL_TYPE_BUTTON;
  std::strncpy(out.name, "Perform FFC", sizeof out.name - 1);
  out.flags = V4L2_CTRL_FLAG_WRITE_ONLY | V4L2_CTRL_FLAG_EXECUTE_ON_WRITE;
  return 0;
}

int EmulatedV4l2Camera::State::set_control(const v4l2_control& in) {
  if (in.id != nuc_button) return EINVAL;
  ++corrections;
  last_correction = exposures;
  frozen_frames = config.nuc_freeze_frames;
  return 0;
}

namespace {

/// Reads the client's structure, serves it and writes it back. Returns the result of `serve`, or EFAULT.
template <typename T, typename Serve>
int with(UMockdevIoctlClient* client, Serve serve) {
  GError* error = nullptr;
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);  // borrowed
  UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(T), &error);
  if (data == nullptr || error != nullptr) {
    g_clear_error(&error);
    return EFAULT;
  }
  T value{};
  std::memcpy(&value, data->data, std::min<std::size_t>(sizeof value, static_cast<std::size_t>(data->data_len)));
  const int result = serve(value);
  if (result == 0) {
    umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8*>(&value), static_cast<gint>(sizeof value));
  }
  g_object_unref(data);
  return result;
}

}  // namespace

int EmulatedV4l2Camera::State::serve(UMockdevIoctlClient* client, std::unique_lock<std::mutex>& lock) {
  if (unplugged) return ENODEV;
  const auto owned = [&] { return owner == client ? 0 : EBUSY; };
  switch (umockdev_ioctl_client_get_request(client) & 0xFFFFFFFFU) {
    case VIDIOC_QUERYCAP:
      return with<v4l2_capability>(client, [&](auto& a) { return query_capability(a); });
    case VIDIOC_ENUM_FMT:
      return with<v4l2_fmtdesc>(client, [&](auto& a) { return enumerate_format(a); });
    case VIDIOC_ENUM_FRAMESIZES:
      return with<v4l2_frmsizeenum>(client, [&](auto& a) { return enumerate_size(a); });
    case VIDIOC_G_FMT:
      return with<v4l2_format>(client, [&](auto& a) { return get_format(a); });
    case VIDIOC_S_FMT:
      return with<v4l2_format>(client, [&](auto& a) { return set_format(a); });
    case VIDIOC_TRY_FMT:
      if (!quirks.has_try_format) return ENOTTY;
      return with<v4l2_format>(client, [&](auto& a) { return made_of(a); });
    case VIDIOC_G_PARM:
      if (!quirks.has_parameters) return ENOTTY;
      return with<v4l2_streamparm>(client, [&](auto& a) { return get_parameters(a); });
    case VIDIOC_S_PARM:
      if (!quirks.has_parameters) return ENOTTY;
      return with<v4l2_streamparm>(client, [&](auto& a) { return set_parameters(a); });
    case VIDIOC_REQBUFS:
      return with<v4l2_requestbuffers>(client, [&](auto& a) { return request_buffers(a, client); });
    case VIDIOC_QUERYBUF:
      return with<v4l2_buffer>(client, [&](auto& a) { return query_buffer(a); });
    case VIDIOC_QBUF:
      return owned() != 0 ? EBUSY : with<v4l2_buffer>(client, [&](auto& a) { return queue_buffer(a); });
    case VIDIOC_DQBUF:
      return owned() != 0 ? EBUSY : with<v4l2_buffer>(client, [&](auto& a) { return dequeue_buffer(a, lock); });
    case VIDIOC_STREAMON:
      return owned() != 0 ? EBUSY : switch_stream(true);
    case VIDIOC_STREAMOFF:
      return owned() != 0 ? EBUSY : switch_stream(false);
    case VIDIOC_QUERY_EXT_CTRL:
      return with<v4l2_query_ext_ctrl>(client, [&](auto& a) { return query_control(a); });
    case VIDIOC_S_CTRL:
      return with<v4l2_control>(client, [&](auto& a) { return set_control(a); });
    default:
      return ENOTTY;
  }
}

int EmulatedV4l2Camera::State::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
  auto* state = static_cast<State*>(data);
  int error = 0;
  {
    std::unique_lock lock(state->mutex);
    error = state->serve(client, lock);
  }
  umockdev_ioctl_client_complete(client, error != 0 ? -1 : 0, error);
  return TRUE;
}

void EmulatedV4l2Camera::State::on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
  auto* state = static_cast<State*>(data);
  const std::lock_guard lock(state->mutex);
  if (state->owner != client) return;
  state->end_stream();
  state->owner = nullptr;
  state->buffers = 0;
}

}  // namespace todbench
