// SPDX-License-Identifier: GPL-3.0-or-later
// Streaming thread of an emulated GVSP camera: exposing, packing, sending, resending.
#include <algorithm>
#include <utility>
#include <vector>

#include "sim_devices/lab/gige/gvsp_camera_state.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Frames that a camera keeps for resend requests.
constexpr std::size_t kept_frames = 16;
/// A camera that is late by more than this continues from now instead of catching up.
constexpr auto most_lag = 250ms;
/// Value of padding and surplus bytes: as pixels they would be near full scale.
constexpr std::uint8_t surplus_byte = 0x3E;

/// A picture with the camera's padding after its rows and after the image.
Bytes padded(Bytes picture, const GvspCameraConfig& config) {
  if (config.row_padding_bytes == 0 && config.image_padding_bytes == 0) return picture;
  const std::size_t row_bytes = picture.size() / static_cast<std::size_t>(config.height);
  Bytes out;
  for (auto row = picture.begin(); row != picture.end(); row += static_cast<std::ptrdiff_t>(row_bytes)) {
    out.insert(out.end(), row, row + static_cast<std::ptrdiff_t>(row_bytes));
    out.insert(out.end(), static_cast<std::size_t>(config.row_padding_bytes), surplus_byte);
  }
  out.insert(out.end(), static_cast<std::size_t>(config.image_padding_bytes), surplus_byte);
  return out;
}

}  // namespace

void GvspCamera::State::resend(const ResendRequest& request) {
  std::shared_ptr<const GvspFrame> frame;
  double loss = 0;
  std::uint64_t draw = 0;
  {
    const std::lock_guard lock(mutex);
    ++counts.resend_requests;
    const auto found =
        std::find_if(kept.begin(), kept.end(), [&](const auto& f) { return f->block_id == request.block_id; });
    if (found != kept.end()) frame = *found;
    loss = faults.packet_loss;
    draw = resend_draws;
    resend_draws += frame ? frame->packets() : 0;
  }
  if (config.resend == ResendPolicy::ignore) return;
  std::vector<GvspPacket> packets;
  if (config.resend == ResendPolicy::unavailable || !frame) {
    packets.push_back(gvsp_unavailable(request.block_id, request.first_packet));
  } else {
    const RandomStream losses(config.seed, "gvsp.resend");
    for (auto id = request.first_packet; id <= request.last_packet && id < frame->packets(); ++id) {
      if (loss > 0 && losses.uniform(draw + id) < loss) continue;
      packets.push_back(gvsp_packet(*frame, id, gvsp_status_resent));
    }
    const std::lock_guard lock(mutex);
    counts.packets_resent += packets.size();
  }
  const auto to = destination();
  if (to.port == 0) return;
  const std::lock_guard lock(sending);
  stream.send(packets, to, 0ns);
}

EncoderSettings GvspCamera::State::encoder_settings() const {
  const ModelRegisters& r = description.registers;
  const auto value = [this](std::uint32_t address) { return address == 0 ? 0 : registers.get(address); };
  EncoderSettings s;
  s.format = pixel_format_of_pfnc(value(r.pixel_format)).value_or(PixelFormat::mono16);
  s.significant_bits = static_cast<unsigned>(config.significant_bits);
  if (r.temperature_linear_mode != 0) {
    s.signal = value(r.temperature_linear_mode) != 0 ? SignalKind::linear : SignalKind::radiometric;
    s.kelvin_per_signal = value(r.temperature_linear_resolution) != 0 ? 0.04 : 0.4;
  } else if (r.ir_format != 0) {
    const auto ir_format = value(r.ir_format);
    s.signal = ir_format == 0 ? SignalKind::radiometric : SignalKind::linear;
    s.kelvin_per_signal = ir_format == 2 ? 0.01 : 0.1;
  }
  s.gain = r.image_adjust != 0 && value(r.image_adjust) == 1 ? GainControl::linear : GainControl::none;
  s.test_ramp = value(r.test_pattern) != 0;
  s.averages = value(r.noise_reduction) != 0;
  s.big_endian =
      config.model == CameraModel::legacy_science || (value(gev::stream_packet_size) & gev::pixels_big_endian) != 0;
  return s;
}

GvspCamera::State::Exposed GvspCamera::State::begin_exposure() {
  const bool automatic = description.registers.nuc_mode != 0 &&
                         registers.get(description.registers.nuc_mode) == description.registers.nuc_mode_automatic;
  const std::lock_guard lock(mutex);
  Exposed out;
  out.index = counts.exposures++;
  clock_ns += period_ns;
  out.timestamp_ns = clock_ns;
  out.acquisition = acquisitions;
  out.block_id = next_block_id;
  next_block_id = static_cast<std::uint16_t>(next_block_id % 65535U + 1U);
  if (automatic && out.index > 0 && out.index % std::max(1U, config.automatic_nuc_frames) == 0) {
    ++counts.corrections;
    frozen_frames = static_cast<unsigned>(config.nuc_freeze_frames);
  }
  out.shutter_closed = frozen_frames > 0;
  if (frozen_frames > 0) --frozen_frames;
  out.faults = faults;
  out.planned = draw_frame_faults(faults, random, out.index);
  counts.faults.frames_lost += out.planned.lost ? 1 : 0;
  counts.faults.frames_frozen += out.planned.frozen ? 1 : 0;
  counts.faults.frames_swapped += out.planned.swapped_bytes ? 1 : 0;
  counts.faults.frames_wrong_size += out.planned.wrong_size ? 1 : 0;
  counts.faults.frames_too_long += out.planned.surplus_bytes > 0 ? 1 : 0;
  counts.faults.late_leaders += out.planned.late_leader ? 1 : 0;
  return out;
}

Bytes GvspCamera::State::picture_of(const Exposed& exposed, const EncoderSettings& settings) {
  if ((exposed.shutter_closed || exposed.planned.frozen) && !last_picture.empty()) return last_picture;
  cv::Mat1w counts_of_exposure;
  try {
    counts_of_exposure = exposure(exposed.index);
  } catch (...) {
    // No exception may end a thread; the owner reads the count.
    counts_of_exposure = {};
  }
  if (counts_of_exposure.cols != config.width || counts_of_exposure.rows != config.height) {
    counts_of_exposure = cv::Mat1w::zeros(config.height, config.width);
    const std::lock_guard lock(mutex);
    ++counts.failed_exposures;
  }
  last_picture = encoder.encode(counts_of_exposure, settings);
  return last_picture;
}

std::shared_ptr<const GvspFrame> GvspCamera::State::frame_of(const Exposed& exposed) {
  const EncoderSettings settings = encoder_settings();
  auto frame = std::make_shared<GvspFrame>();
  frame->block_id = exposed.block_id;
  frame->exposure = exposed.index;
  frame->timestamp_ns = exposed.timestamp_ns;
  frame->pixel_format = registers.get(description.registers.pixel_format);
  frame->width = static_cast<std::uint32_t>(config.width);
  frame->height = static_cast<std::uint32_t>(config.height);
  const auto packet_bytes =
      std::max(registers.get(gev::stream_packet_size) & gev::packet_size_mask, gvsp_least_packet_bytes);
  frame->bytes_per_packet = packet_bytes - gvsp_overhead_bytes;
  frame->data = picture_of(exposed, settings);
  if (exposed.planned.swapped_bytes && settings.format != PixelFormat::mono8) swap_bytes(frame->data);
  frame->data = padded(std::move(frame->data), config);
  if (config.states_padding) {
    frame->x_padding = static_cast<std::uint16_t>(config.row_padding_bytes);
    frame->y_padding = static_cast<std::uint16_t>(config.image_padding_bytes);
  }
  if (exposed.planned.wrong_size) {
    const std::size_t row_bytes = frame->data.size() / frame->height;
    frame->height /= 2;
    frame->data.resize(row_bytes * frame->height);
  }
  frame->data.resize(frame->data.size() + exposed.planned.surplus_bytes, surplus_byte);
  if (registers.get(description.registers.chunk_mode) == 0) return frame;
  frame->payload_type = config.chunk_payload_type;
  if (frame->payload_type == 4) frame->width = frame->height = 0;
  const Bytes image = std::move(frame->data);
  frame->data.clear();
  append_chunk(frame->data, chunk_image, image);
  Bytes content;
  append_big_endian(content, exposed.index, 8);
  append_chunk(frame->data, chunk_exposure, content);
  content.clear();
  append_big_endian(content, registers.get(description.registers.sensor_temperature), 4);
  append_chunk(frame->data, chunk_sensor_temperature, content);
  content.clear();
  append_big_endian(content, exposed.shutter_closed ? 1 : 0, 4);
  append_chunk(frame->data, chunk_nuc_active, content);
  return frame;
}

void GvspCamera::State::send_frame(const GvspFrame& frame, const Exposed& exposed) {
  const auto to = destination();
  if (exposed.planned.lost || to.port == 0 || link_is_down()) return;
  const PacketSchedule schedule =
      schedule_packets(frame.packets(), exposed.planned, exposed.faults, random, exposed.index);
  {
    const std::lock_guard lock(mutex);
    // An exposure in progress when the client stopped belongs to no later stream.
    if (!acquiring || acquisitions != exposed.acquisition) return;
    counts.faults.packets_lost += schedule.lost;
    counts.faults.packets_duplicated += schedule.duplicated;
    counts.faults.packets_reordered += schedule.reordered;
    counts.faults.frames_with_holes += schedule.lost > 0 ? 1 : 0;
  }
  std::vector<GvspPacket> packets;
  packets.reserve(schedule.ids.size());
  for (const auto id : schedule.ids) packets.push_back(gvsp_packet(frame, id, gvsp_status_success));
  const std::chrono::nanoseconds pause(registers.get(gev::stream_packet_delay));
  const std::lock_guard lock(sending);
  stream.send(packets, to, pause);
}

void GvspCamera::State::serve_stream(const std::stop_token& stop) {
  auto due = Clock::now();
  bool running = false;
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex);
      if (!acquiring) {
        running = false;
        changed.wait(lock, stop, [this] { return acquiring; });
        continue;
      }
      const std::chrono::nanoseconds period(period_ns);
      due = running ? due + period : Clock::now() + period;
      running = true;
      if (Clock::now() > due + most_lag) due = Clock::now();
      if (Clock::now() > due + period) ++counts.late_exposures;
      if (changed.wait_until(lock, stop, due, [this] { return !acquiring; })) continue;
    }
    if (stop.stop_requested()) return;
    const Exposed exposed = begin_exposure();
    const auto frame = frame_of(exposed);
    {
      const std::lock_guard lock(mutex);
      if (!exposed.planned.lost) kept.push_back(frame);
      while (kept.size() > kept_frames) kept.pop_front();
    }
    send_frame(*frame, exposed);
  }
}

}  // namespace todbench
