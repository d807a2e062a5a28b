// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/uvc_camera.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint8_t stream_interface = 1, stream_endpoint = 0x81;
/// Of one payload, header included: what uvcvideo fetches in one transfer of a high-speed bulk endpoint.
constexpr std::uint32_t payload_bytes = 16384;
constexpr std::size_t header_bytes = 2;
constexpr std::uint8_t header_frame_id = 0x01, header_end_of_frame = 0x02, header_end = 0x80;

// USB Video Class 1.0, tables and 4-47.
enum Request : std::uint8_t { set_cur = 0x01, get_cur = 0x81, get_min, get_max, get_res, get_len, get_info, get_def };
constexpr std::uint8_t probe_control = 1, commit_control = 2;
constexpr std::size_t probe_bytes = 26;

class Bytes {
 public:
  Bytes& u8(unsigned value) {
    bytes_.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  Bytes& u16(unsigned value) { return u8(value & 0xFFU).u8(value >> 8U & 0xFFU); }
  Bytes& u32(std::uint32_t value) { return u16(value & 0xFFFFU).u16(value >> 16U); }
  Bytes& all(const UsbBytes& more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
    return *this;
  }
  [[nodiscard]] const UsbBytes& get() const { return bytes_; }

 private:
  UsbBytes bytes_;
};

std::uint32_t interval_100ns(double frame_rate_hz) {
  return static_cast<std::uint32_t>(std::lround(1e7 / frame_rate_hz));
}

/// A format is named by a GUID that begins with its four-character code; that of V4L2's YUYV is called YUY2.
UsbBytes format_guid(std::uint32_t fourcc) {
  constexpr std::uint32_t yuyv = 0x56595559, yuy2 = 0x32595559;
  return Bytes()
      .u32(fourcc == yuyv ? yuy2 : fourcc)
      .all({0x00, 0x00, 0x10, 0x00, 0x80, 0x00, 0x00, 0xAA, 0x00, 0x38, 0x9B, 0x71})
      .get();
}

UsbBytes control_interface() {
  const UsbBytes camera =
      Bytes().u8(18).u8(0x24).u8(0x02).u8(1).u16(0x0201).u8(0).u8(0).u16(0).u16(0).u16(0).u8(3).u8(0).u16(0).get();
  const UsbBytes output = Bytes().u8(9).u8(0x24).u8(0x03).u8(2).u16(0x0101).u8(0).u8(1).u8(0).get();
  const unsigned total = 13 + static_cast<unsigned>(camera.size() + output.size());
  return Bytes()
      .u8(9)
      .u8(4)
      .u8(0)
      .u8(0)
      .u8(0)
      .u8(0x0E)
      .u8(0x01)
      .u8(0)
      .u8(0)
      .u8(13)
      .u8(0x24)
      .u8(0x01)
      .u16(0x0100)
      .u16(total)
      .u32(48'000'000)
      .u8(1)
      .u8(stream_interface)
      .all(camera)
      .all(output)
      .get();
}

UsbBytes stream_interface_descriptors(const VideoCameraConfig& config, const VideoWireFormat& format) {
  Bytes formats;
  formats.u8(27)
      .u8(0x24)
      .u8(0x04)
      .u8(1)
      .u8(static_cast<unsigned>(format.sizes.size()))
      .all(format_guid(format.fourcc()))
      .u8(static_cast<unsigned>(8 * format.bytes_per_pixel()))
      .u8(1)
      .u8(0)
      .u8(0)
      .u8(0)
      .u8(0);
  for (std::size_t i = 0; i < format.sizes.size(); ++i) {
    const auto bytes = static_cast<std::uint32_t>(format.sizes[i].area() * format.bytes_per_pixel());
    const auto bits_per_second = static_cast<std::uint32_t>(8 * bytes * config.frame_rate_hz);
    formats.u8(30)
        .u8(0x24)
        .u8(0x05)
        .u8(static_cast<unsigned>(i + 1))
        .u8(0)
        .u16(static_cast<unsigned>(format.sizes[i].width))
        .u16(static_cast<unsigned>(format.sizes[i].height))
        .u32(bits_per_second)
        .u32(bits_per_second)
        .u32(bytes)
        .u32(interval_100ns(config.frame_rate_hz))
        .u8(1)
        .u32(interval_100ns(config.frame_rate_hz));
  }
  const unsigned total = 14 + static_cast<unsigned>(formats.get().size());
  return Bytes()
      .u8(9)
      .u8(4)
      .u8(stream_interface)
      .u8(0)
      .u8(1)
      .u8(0x0E)
      .u8(0x02)
      .u8(0)
      .u8(0)
      .u8(14)
      .u8(0x24)
      .u8(0x01)
      .u8(1)
      .u16(total)
      .u8(stream_endpoint)
      .u8(0)
      .u8(2)
      .u8(0)
      .u8(0)
      .u8(0)
      .u8(1)
      .u8(0)
      .all(formats.get())
      .u8(7)
      .u8(5)
      .u8(stream_endpoint)
      .u8(2)
      .u16(512)
      .u8(0)
      .get();
}

UsbDescriptors descriptors_of(const VideoCameraConfig& config, const VideoWireFormat& format) {
  const UsbIdentity usb = usb_identity(config.kind);
  UsbDescriptors d;
  d.device = Bytes()
                 .u8(18)
                 .u8(1)
                 .u16(0x0200)
                 .u8(0xEF)
                 .u8(2)
                 .u8(1)
                 .u8(64)
                 .u16(usb.vendor)
                 .u16(usb.product)
                 .u16(0x0100)
                 .u8(1)
                 .u8(2)
                 .u8(3)
                 .u8(1)
                 .get();
  const UsbBytes association = Bytes().u8(8).u8(11).u8(0).u8(2).u8(0x0E).u8(0x03).u8(0).u8(0).get();
  const UsbBytes control = control_interface();
  const UsbBytes stream = stream_interface_descriptors(config, format);
  const unsigned total = 9 + static_cast<unsigned>(association.size() + control.size() + stream.size());
  d.configuration =
      Bytes().u8(9).u8(2).u16(total).u8(2).u8(1).u8(0).u8(0x80).u8(250).all(association).all(control).all(stream).get();
  d.strings = {config.vendor, config.model, config.serial};
  d.speed = UsbSpeed::high;
  return d;
}

}  // namespace

struct UvcCamera::State {
  VideoCameraConfig config;
  Exposure exposure;
  VideoWireFormat format;
  UsbDescriptors descriptors;

  mutable std::mutex mutex;
  std::condition_variable_any changed;
  bool streaming = false;
  std::size_t probed_frame = 0, committed_frame = 0;
  std::uint64_t exposures = 0;
  UsbBytes frame;        ///< being fetched
  std::size_t sent = 0;  ///< of it
  std::uint8_t frame_id = 0;
  Clock::time_point due;

  [[nodiscard]] cv::Size size(std::size_t frame_index) const { return format.sizes[frame_index]; }
  [[nodiscard]] UsbBytes streaming_parameters(std::size_t frame_index) const;
  [[nodiscard]] std::optional<UsbBytes> stream_control(const UsbSetup& setup, std::span<const std::uint8_t> data);
  [[nodiscard]] UsbBytes next_payload(std::size_t length);
};

UsbBytes UvcCamera::State::streaming_parameters(std::size_t frame_index) const {
  const auto bytes = static_cast<std::uint32_t>(size(frame_index).area() * format.bytes_per_pixel());
  return Bytes()
      .u16(1)
      .u8(1)
      .u8(static_cast<unsigned>(frame_index + 1))
      .u32(interval_100ns(config.frame_rate_hz))
      .u16(0)
      .u16(0)
      .u16(0)
      .u16(0)
      .u16(0)
      .u32(bytes)
      .u32(payload_bytes)
      .get();
}

std::optional<UsbBytes> UvcCamera::State::stream_control(const UsbSetup& setup, std::span<const std::uint8_t> data) {
  const unsigned selector = setup.value >> 8U;
  if (selector != probe_control && selector != commit_control) return std::nullopt;
  switch (setup.request) {
    case set_cur: {
      if (data.size() < 4) return std::nullopt;
      const std::size_t wanted = data[3];
      probed_frame = wanted >= 1 && wanted <= format.sizes.size() ? wanted - 1 : 0;
      if (selector == commit_control) {
        committed_frame = probed_frame;
        streaming = true;
        frame.clear();
        due = Clock::now();
        changed.notify_all();
      }
      return UsbBytes{};
    }
    case get_cur:
      return streaming_parameters(selector == probe_control ? probed_frame : committed_frame);
    case get_min:
    case get_max:
    case get_def:
      return streaming_parameters(probed_frame);
    case get_len:
      return Bytes().u16(probe_bytes).get();
    case get_info:
      return UsbBytes{0x03};  // can be read and written
    default:
      return std::nullopt;
  }
}

UsbBytes UvcCamera::State::next_payload(std::size_t length) {
  const std::size_t room = std::min<std::size_t>(length, payload_bytes);
  if (room <= header_bytes) return {};
  const std::size_t count = std::min(room - header_bytes, frame.size() - sent);
  const bool last = sent + count == frame.size();
  UsbBytes payload{static_cast<std::uint8_t>(header_bytes),
                   static_cast<std::uint8_t>(header_end | frame_id | (last ? header_end_of_frame : 0))};
  const auto from = frame.begin() + static_cast<std::ptrdiff_t>(sent);
  payload.insert(payload.end(), from, from + static_cast<std::ptrdiff_t>(count));
  sent += count;
  if (last) {
    frame.clear();
    frame_id ^= header_frame_id;
  }
  return payload;
}

UvcCamera::UvcCamera(std::unique_ptr<State> state) : state_(std::move(state)) {}
UvcCamera::~UvcCamera() = default;

Result<std::unique_ptr<UvcCamera>> UvcCamera::create(VideoCameraConfig config, Exposure exposure) {
  if (const auto valid = validate(config); !valid) return tl::unexpected(valid.error());
  if (!exposure) return fail(ErrorCode::invalid_input, "emulated UVC camera: there is nothing to expose");
  if (config.kind == VideoCameraKind::y14 || config.kind == VideoCameraKind::grey) {
    return fail(ErrorCode::invalid_input, "emulated UVC camera: 16 bits only");
  }
  auto state = std::make_unique<State>();
  state->format = wire_format(config);
  state->descriptors = descriptors_of(config, state->format);
  state->config = std::move(config);
  state->exposure = std::move(exposure);
  return std::unique_ptr<UvcCamera>(new UvcCamera(std::move(state)));
}

const UsbDescriptors& UvcCamera::descriptors() const {
  return state_->descriptors;
}

std::optional<UsbBytes> UvcCamera::control(const UsbSetup& setup, std::span<const std::uint8_t> data) {
  constexpr std::uint8_t to_endpoint = 0x02, clear_feature = 1, class_request = 0x20, of_kind = 0x60;
  const std::lock_guard lock(state_->mutex);
  if (setup.request_type == to_endpoint && setup.request == clear_feature) {
    // The host ends a bulk stream by clearing the halt of its endpoint.
    state_->streaming = false;
    state_->frame.clear();
    return UsbBytes{};
  }
  if ((setup.request_type & of_kind) != class_request || (setup.index & 0xFFU) != stream_interface) return std::nullopt;
  return state_->stream_control(setup, data);
}

bool UvcCamera::bulk_out(std::uint8_t /*endpoint*/, std::span<const std::uint8_t> /*data*/) {
  return false;
}

std::optional<UsbBytes> UvcCamera::bulk_in(std::uint8_t endpoint, std::size_t length, std::stop_token stop) {
  if (endpoint != stream_endpoint) return std::nullopt;
  std::unique_lock lock(state_->mutex);
  while (state_->frame.empty()) {
    if (!state_->changed.wait(lock, stop, [&] { return state_->streaming; })) return std::nullopt;
    const auto due = state_->due;
    if (state_->changed.wait_until(lock, stop, due, [&] { return !state_->streaming; })) continue;
    if (stop.stop_requested()) return std::nullopt;
    const std::uint64_t index = state_->exposures++;
    const auto period =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / state_->config.frame_rate_hz));
    state_->due = std::max(due + period, Clock::now());
    state_->frame =
        wire_frame(state_->config, state_->exposure(index), state_->size(state_->committed_frame), {.exposure = index});
    state_->sent = 0;
  }
  return state_->next_payload(length);
}

std::uint64_t UvcCamera::exposures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->exposures;
}

}  // namespace todbench
