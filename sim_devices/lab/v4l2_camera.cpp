#include "sim_devices/lab/v4l2_camera.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <umockdev.h>
#include <unistd.h>
// after sys/ioctl.h
#include <linux/videodev2.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

namespace todbench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t most_buffers = 32;
/// poll() on the node is always ready: a DQBUF waits a little instead, so that a client does not spin.
constexpr auto dequeue_patience = 10ms;
constexpr std::uint32_t nuc_button = V4L2_CID_PRIVATE_BASE;
constexpr std::size_t page = 4096;

/// Nodes of a process, so that no two emulated cameras share one.
std::atomic<int> next_node_number{0};

std::string usb_path(int number) {
  return "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number + 1);
}
std::string video_path(int number) {
  return usb_path(number) + "/1-" + std::to_string(number + 1) + ":1.0/video4linux/video" + std::to_string(number);
}

std::string hexadecimal(unsigned value) {
  char text[8];
  std::snprintf(text, sizeof text, "%04x", value);
  return text;
}

/// The USB device and its video node, as sysfs shows them. "=00" makes the node a regular file.
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

template <std::size_t N>
void put_text(__u8 (&field)[N], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), N - 1));
}

}  // namespace

/// A driver in user space: `mutex` guards everything below it.
struct EmulatedV4l2Camera::State {
  VideoCameraConfig config;
  Exposure exposure;
  VideoWireFormat format;
  int number = 0;
  int file = -1;  ///< the node, which holds the buffers
  std::shared_ptr<MockSystem> system;
  UMockdevIoctlBase* handler = nullptr;

  std::mutex mutex;
  std::condition_variable_any changed;
  bool unplugged = false;
  UMockdevIoctlClient* owner = nullptr;  ///< who has buffers; never dereferenced
  cv::Size size;
  double frame_rate_hz = 50;
  std::uint32_t buffers = 0;
  std::uint32_t buffer_bytes = 0;
  bool streaming = false;
  std::deque<std::uint32_t> queued;
  std::deque<v4l2_buffer> done;
  std::uint32_t sequence = 0;
  std::uint64_t exposures = 0, failed = 0, corrections = 0, last_correction = 0;
  int frozen_frames = 0;
  unsigned to_lose = 0;
  std::optional<std::uint32_t> truncated;
  cv::Mat1w last;
  std::jthread camera;

  ~State() {
    camera = {};
    if (handler != nullptr) {
      umockdev_testbed_detach_ioctl(system->testbed(), ("/dev/video" + std::to_string(number)).c_str(), nullptr);
      g_object_unref(handler);
    }
    if (file >= 0) ::close(file);
  }

  [[nodiscard]] std::uint32_t image_bytes() const {
    return static_cast<std::uint32_t>(size.area() * format.bytes_per_pixel);
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
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer state);
  static void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer state);
};

// --- the camera -------------------------------------------------------------------------------------------------

cv::Mat1w EmulatedV4l2Camera::State::picture(std::uint64_t index) {
  cv::Mat1w counts;
  try {
    counts = exposure(index);
  } catch (...) {
    // Nothing may end the camera's thread; the owner sees the count.
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
  const auto bytes = wire_frame(
      config, counts, size,
      {.exposure = index, .correcting = frozen_frames > 0, .last_correction = corrections > 0 ? last_correction : 0});
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
  if (truncated) {
    buffer.bytesused = std::min(buffer.bytesused, *truncated);
    buffer.flags |= V4L2_BUF_FLAG_ERROR;
    truncated.reset();
  }
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
    // The scene is looked at without the lock: a client must not wait for it.
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

// --- the driver -------------------------------------------------------------------------------------------------

int EmulatedV4l2Camera::State::query_capability(v4l2_capability& out) const {
  out = {};
  put_text(out.driver, "uvcvideo");
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
  out.pixelformat = format.fourcc;
  return 0;
}

int EmulatedV4l2Camera::State::enumerate_size(v4l2_frmsizeenum& out) const {
  if (out.pixel_format != format.fourcc || out.index >= format.sizes.size()) return EINVAL;
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
  out.fmt.pix.pixelformat = format.fourcc;
  out.fmt.pix.field = V4L2_FIELD_NONE;
  out.fmt.pix.bytesperline = static_cast<__u32>(size.width * format.bytes_per_pixel);
  out.fmt.pix.sizeimage = image_bytes();
  out.fmt.pix.colorspace = V4L2_COLORSPACE_SRGB;
  return 0;
}

int EmulatedV4l2Camera::State::try_format(v4l2_format& out, cv::Size& chosen) const {
  if (out.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return EINVAL;
  // As uvcvideo: a size that does not exist becomes one that does.
  chosen = format.sizes.front();
  for (const auto& s : format.sizes) {
    if (static_cast<__u32>(s.width) == out.fmt.pix.width && static_cast<__u32>(s.height) == out.fmt.pix.height)
      chosen = s;
  }
  return 0;
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

/// The client's structure, read, served and written back. The result of `serve`, or EFAULT.
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
    case VIDIOC_G_PARM:
      return with<v4l2_streamparm>(client, [&](auto& a) { return get_parameters(a); });
    case VIDIOC_S_PARM:
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

gboolean EmulatedV4l2Camera::State::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
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

// --- outside ----------------------------------------------------------------------------------------------------

EmulatedV4l2Camera::EmulatedV4l2Camera(std::unique_ptr<State> state) : state_(std::move(state)) {}

EmulatedV4l2Camera::~EmulatedV4l2Camera() {
  unplug();
}

Result<std::unique_ptr<EmulatedV4l2Camera>> EmulatedV4l2Camera::start(std::shared_ptr<MockSystem> system,
                                                                      VideoCameraConfig config, Exposure exposure) {
  if (const auto valid = validate(config); !valid) return tl::unexpected(valid.error());
  if (!exposure) return fail(ErrorCode::invalid_input, "emulated video camera: there is nothing to expose");
  auto state = std::make_unique<State>();
  state->config = std::move(config);
  state->exposure = std::move(exposure);
  state->format = wire_format(state->config);
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

}  // namespace todbench
