// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/video_device.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace todbench {
namespace {

constexpr std::uint32_t capture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
/// Limit for the enumerations of a hostile or broken driver.
constexpr std::uint32_t most_formats = 256;
/// Larger than any camera; a driver replaces it by its largest size.
constexpr int largest_tried = 16384;
/// More buffers than any driver grants.
constexpr std::uint32_t most_buffers = 1024;
constexpr std::size_t page_bytes = 4096;

bool is_size(std::uint32_t width, std::uint32_t height) {
  return width >= 1 && height >= 1 && width <= 65535 && height <= 65535;
}

/// 0 for a time that does not fit into nanoseconds.
std::int64_t nanoseconds(const timeval& time) {
  const std::int64_t seconds = time.tv_sec, microseconds = time.tv_usec;
  constexpr std::int64_t most_seconds = 9'000'000'000;
  if (seconds < 0 || seconds > most_seconds || microseconds < 0 || microseconds >= 1'000'000) return 0;
  return seconds * 1'000'000'000 + microseconds * 1000;
}

template <std::size_t N>
std::string text_of(const __u8 (&field)[N]) {
  const auto* end = std::find(std::begin(field), std::end(field), 0);
  return {std::begin(field), end};
}

std::string name_of_errno(int error_number) {
  return std::strerror(error_number);
}

/// Drivers cannot handle 32 fractional bits of a rate; thousandths keep 29.97 Hz.
v4l2_fract interval_of(double frame_rate_hz) {
  return {.numerator = 1000, .denominator = static_cast<__u32>(std::lround(1000 * frame_rate_hz))};
}

v4l2_buffer mapped_buffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = capture;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

Error video_error(int error_number, const std::string& doing, ErrorCode otherwise) {
  if (error_number == ENODEV || error_number == ENXIO || error_number == ESHUTDOWN) {
    return {ErrorCode::disconnected, doing + ": the device is no longer connected"};
  }
  if (error_number == EBUSY) return {otherwise, doing + ": busy: another program uses the camera"};
  return {otherwise, doing + ": " + name_of_errno(error_number)};
}

VideoDevice::Mapping::~Mapping() {
  if (data_ != nullptr) ::munmap(data_, length_);
}
VideoDevice::Mapping::Mapping(Mapping&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), length_(other.length_) {}

VideoDevice::VideoDevice(Descriptor fd, VideoCapability capability)
    : fd_(std::move(fd)), capability_(std::move(capability)) {}

VideoDevice::~VideoDevice() {
  if (fd_.is_open()) stop();
}

int VideoDevice::call(unsigned long request, void* argument) const {
  while (::ioctl(fd_.get(), request, argument) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

Result<VideoDevice> VideoDevice::open(const std::string& node) {
  Descriptor fd(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (!fd.is_open()) {
    const int reason = errno;
    const std::string mend =
        reason == EACCES || reason == EPERM
            ? "; add yourself to the group 'video' or install the udev rule of docs/guide/connect-a-camera.md"
            : "";
    return fail(ErrorCode::not_found, "opening " + node + ": " + name_of_errno(reason) + mend);
  }
  VideoDevice device(std::move(fd), {});
  v4l2_capability said{};
  if (const int error = device.call(VIDIOC_QUERYCAP, &said); error != 0) {
    return fail(ErrorCode::not_found, node + " is not a video device: " + name_of_errno(error));
  }
  const std::uint32_t can = (said.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? said.device_caps : said.capabilities;
  device.capability_ = {.driver = text_of(said.driver),
                        .card = text_of(said.card),
                        .bus = text_of(said.bus_info),
                        .version = said.version,
                        .captures = (can & V4L2_CAP_VIDEO_CAPTURE) != 0 && (can & V4L2_CAP_STREAMING) != 0};
  return device;
}

std::vector<VideoMode> VideoDevice::listed_sizes(std::uint32_t fourcc) const {
  std::vector<VideoMode> modes;
  for (std::uint32_t s = 0; s < most_formats; ++s) {
    v4l2_frmsizeenum size{};
    size.pixel_format = fourcc;
    size.index = s;
    if (call(VIDIOC_ENUM_FRAMESIZES, &size) != 0) break;
    const bool discrete = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
    const std::uint32_t width = discrete ? size.discrete.width : size.stepwise.max_width;
    const std::uint32_t height = discrete ? size.discrete.height : size.stepwise.max_height;
    if (is_size(width, height)) modes.push_back({fourcc, static_cast<int>(width), static_cast<int>(height)});
    if (!discrete) break;
  }
  return modes;
}

std::optional<VideoMode> VideoDevice::tried(VideoMode wanted) const {
  v4l2_format format{};
  format.type = capture;
  format.fmt.pix.width = static_cast<__u32>(wanted.width);
  format.fmt.pix.height = static_cast<__u32>(wanted.height);
  format.fmt.pix.pixelformat = wanted.fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const v4l2_pix_format& pix = format.fmt.pix;
  if (call(VIDIOC_TRY_FMT, &format) != 0 || pix.pixelformat != wanted.fourcc || !is_size(pix.width, pix.height)) {
    return std::nullopt;
  }
  return VideoMode{pix.pixelformat, static_cast<int>(pix.width), static_cast<int>(pix.height)};
}

std::vector<VideoMode> VideoDevice::tried_sizes(std::uint32_t fourcc) const {
  std::vector<VideoMode> modes;
  const auto add = [&modes](const std::optional<VideoMode>& mode) {
    if (mode && std::find(modes.begin(), modes.end(), *mode) == modes.end()) modes.push_back(*mode);
  };
  add(tried({fourcc, largest_tried, largest_tried}));
  add(tried({fourcc, 1, 1}));
  v4l2_format present{};
  present.type = capture;
  const v4l2_pix_format& pix = present.fmt.pix;
  if (call(VIDIOC_G_FMT, &present) == 0 && pix.pixelformat == fourcc && is_size(pix.width, pix.height)) {
    add(VideoMode{fourcc, static_cast<int>(pix.width), static_cast<int>(pix.height)});
  }
  return modes;
}

std::vector<VideoMode> VideoDevice::modes(const std::optional<cv::Size>& also) const {
  std::vector<VideoMode> modes;
  for (std::uint32_t f = 0; f < most_formats; ++f) {
    v4l2_fmtdesc format{};
    format.type = capture;
    format.index = f;
    if (call(VIDIOC_ENUM_FMT, &format) != 0) break;
    auto sizes = listed_sizes(format.pixelformat);
    if (sizes.empty()) sizes = tried_sizes(format.pixelformat);
    if (also) {
      const auto mode = tried({format.pixelformat, also->width, also->height});
      if (mode && std::find(sizes.begin(), sizes.end(), *mode) == sizes.end()) sizes.push_back(*mode);
    }
    modes.insert(modes.end(), sizes.begin(), sizes.end());
  }
  return modes;
}

Result<VideoLayout> VideoDevice::set_format(VideoLayout layout) {
  v4l2_format format{};
  format.type = capture;
  format.fmt.pix.width = static_cast<__u32>(layout.mode.width);
  format.fmt.pix.height = static_cast<__u32>(layout.mode.height);
  format.fmt.pix.pixelformat = layout.mode.fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const std::string doing = "setting " + fourcc_text(layout.mode.fourcc) + " " + std::to_string(layout.mode.width) +
                            "x" + std::to_string(layout.mode.height);
  if (const int error = call(VIDIOC_S_FMT, &format); error != 0) {
    return tl::unexpected(video_error(error, doing, ErrorCode::not_found));
  }
  const v4l2_pix_format& pix = format.fmt.pix;
  if (pix.pixelformat != layout.mode.fourcc || pix.width != static_cast<__u32>(layout.mode.width) ||
      pix.height != static_cast<__u32>(layout.mode.height)) {
    return fail(ErrorCode::not_found, doing + ": the camera set " + fourcc_text(pix.pixelformat) + " " +
                                          std::to_string(pix.width) + "x" + std::to_string(pix.height) + " instead");
  }
  // Some drivers leave bytesperline at 0: rows without padding.
  layout.row_bytes = std::max<std::size_t>(layout.row_bytes, pix.bytesperline);
  image_bytes_ = pix.sizeimage;
  // A driver that transfers whole pages states this size for every frame. Frames of a USB camera contain no filler.
  const std::size_t rows = layout.row_bytes * static_cast<std::size_t>(layout.mode.height);
  const bool whole_pages = image_bytes_ % page_bytes == 0 && image_bytes_ > rows && image_bytes_ - rows < page_bytes;
  layout.filler_bytes = whole_pages && capability_.driver != "uvcvideo" ? image_bytes_ - rows : 0;
  return layout;
}

Result<void> VideoDevice::check_format(const VideoLayout& layout) const {
  v4l2_format format{};
  format.type = capture;
  if (const int error = call(VIDIOC_G_FMT, &format); error != 0) {
    return tl::unexpected(video_error(error, "reading the format", ErrorCode::not_found));
  }
  const v4l2_pix_format& pix = format.fmt.pix;
  if (pix.pixelformat == layout.mode.fourcc && pix.width == static_cast<__u32>(layout.mode.width) &&
      pix.height == static_cast<__u32>(layout.mode.height)) {
    return {};
  }
  return fail(ErrorCode::not_found, "another program has set " + fourcc_text(pix.pixelformat) + " " +
                                        std::to_string(pix.width) + "x" + std::to_string(pix.height));
}

double VideoDevice::frame_rate_hz() const {
  v4l2_streamparm parameters{};
  parameters.type = capture;
  if (call(VIDIOC_G_PARM, &parameters) != 0) return 0;
  const v4l2_fract& interval = parameters.parm.capture.timeperframe;
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0;
}

Result<void> VideoDevice::set_frame_rate(double frame_rate_hz) {
  if (!(frame_rate_hz >= 0.1 && frame_rate_hz <= 10000)) {
    return fail(ErrorCode::invalid_input,
                "a frame rate of " + std::to_string(frame_rate_hz) + " Hz, expected 0.1 ... 10000 Hz");
  }
  v4l2_streamparm parameters{};
  parameters.type = capture;
  parameters.parm.capture.timeperframe = interval_of(frame_rate_hz);
  if (const int error = call(VIDIOC_S_PARM, &parameters); error != 0) {
    return tl::unexpected(video_error(error, "setting the frame rate", ErrorCode::invalid_input));
  }
  return {};
}

Result<void> VideoDevice::map_and_queue(unsigned index) {
  v4l2_buffer buffer = mapped_buffer(index);
  if (const int error = call(VIDIOC_QUERYBUF, &buffer); error != 0) {
    return tl::unexpected(video_error(error, "querying a buffer", ErrorCode::not_found));
  }
  void* data = ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_.get(), buffer.m.offset);
  if (data == MAP_FAILED) {
    return tl::unexpected(video_error(errno, "mapping a buffer", ErrorCode::not_found));
  }
  buffers_.emplace_back(data, buffer.length);
  buffer = mapped_buffer(index);
  if (const int error = call(VIDIOC_QBUF, &buffer); error != 0) {
    return tl::unexpected(video_error(error, "enqueuing a buffer", ErrorCode::not_found));
  }
  return {};
}

Result<void> VideoDevice::start(unsigned buffers) {
  stop();
  v4l2_requestbuffers request{};
  request.count = buffers;
  request.type = capture;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = call(VIDIOC_REQBUFS, &request); error != 0) {
    return tl::unexpected(video_error(error, "requesting buffers", ErrorCode::not_found));
  }
  requested_ = true;
  Result<void> done;
  if (request.count > most_buffers) {
    done = fail(ErrorCode::not_found, "the driver grants " + std::to_string(request.count) + " buffers, at most " +
                                          std::to_string(most_buffers) + " are supported");
  }
  for (unsigned i = 0; i < request.count && done; ++i) done = map_and_queue(i);
  if (done && request.count < 2) {
    done = fail(ErrorCode::not_found,
                "the driver grants " + std::to_string(request.count) + " buffers, at least 2 are needed");
  }
  if (done) {
    int type = capture;
    if (const int error = call(VIDIOC_STREAMON, &type); error != 0) {
      done = tl::unexpected(video_error(error, "starting the stream", ErrorCode::not_found));
    }
  }
  if (!done) stop();
  return done;
}

void VideoDevice::stop() {
  if (!requested_) return;
  requested_ = false;
  int type = capture;
  static_cast<void>(call(VIDIOC_STREAMOFF, &type));
  buffers_.clear();
  v4l2_requestbuffers request{};
  request.type = capture;
  request.memory = V4L2_MEMORY_MMAP;
  static_cast<void>(call(VIDIOC_REQBUFS, &request));
}

Result<bool> VideoDevice::take(const std::function<void(const VideoBuffer&)>& use) {
  v4l2_buffer buffer = mapped_buffer(0);
  if (const int error = call(VIDIOC_DQBUF, &buffer); error != 0) {
    if (error == EAGAIN) return false;
    return tl::unexpected(video_error(error, "dequeuing a buffer", ErrorCode::disconnected));
  }
  if (buffer.index >= buffers_.size()) {
    return fail(ErrorCode::disconnected, "the driver returned buffer " + std::to_string(buffer.index) + " of " +
                                             std::to_string(buffers_.size()));
  }
  const auto bytes = buffers_[buffer.index].bytes();
  const std::size_t stated = buffer.bytesused;
  use({.bytes = bytes.first(std::min(bytes.size(), stated)),
       .sequence = buffer.sequence,
       .time_ns = nanoseconds(buffer.timestamp),
       .damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || stated == 0,
       .oversized = stated > bytes.size() || (image_bytes_ > 0 && stated > image_bytes_)});
  v4l2_buffer again = mapped_buffer(buffer.index);
  if (const int error = call(VIDIOC_QBUF, &again); error != 0) {
    return tl::unexpected(video_error(error, "enqueuing a buffer", ErrorCode::disconnected));
  }
  return true;
}

}  // namespace todbench
