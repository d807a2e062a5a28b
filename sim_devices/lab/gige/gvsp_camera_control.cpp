// SPDX-License-Identifier: GPL-3.0-or-later
// Control thread of an emulated GVSP camera: registers and their side effects.
#include <fmt/format.h>
#include <cmath>

#include "sim_devices/lab/gige/gvsp_camera_state.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Interval between checks of the heartbeat.
constexpr auto control_patience = 50ms;
/// Bytes that chunk mode adds to an image: four chunks with id and length, and contents of 8, 4 and 4 bytes besides the
/// image.
constexpr std::uint32_t chunk_bytes = 4 * 8 + 8 + 4 + 4;
constexpr std::uint32_t default_packet_bytes = 1400;

bool asks_for_memory(std::span<const std::uint8_t> datagram) {
  const auto request = parse_gvcp_request(datagram);
  return request && request->command == static_cast<std::uint16_t>(GvcpCommand::read_memory);
}

}  // namespace

std::uint64_t gvsp_period_ns(double rate_hz) {
  return 1000 * static_cast<std::uint64_t>(std::lround(1e6 / rate_hz));
}

void GvspCamera::State::power_up() {
  registers.power_up();
  registers.unlock_transport();
  const auto set = [this](std::uint32_t address, std::uint32_t value) { registers.set(address, value); };
  set(gev::version, 0x00010002);
  set(gev::device_mode, 0x80000001);  // big-endian transmitter, UTF-8
  set(gev::mac_high, 0x0000AA00);     // a locally administered address
  set(gev::mac_low, 0x54420000 | (interface.address & 0xFFFF));
  set(gev::supported_ip_configuration, 7);
  set(gev::current_ip_configuration, 5);
  set(gev::current_ip_address, interface.address);
  set(gev::current_subnet_mask, interface.mask);
  registers.set_text(gev::vendor_name, description.genicam.vendor, 32);
  registers.set_text(gev::model_name, description.genicam.model, 32);
  registers.set_text(gev::device_version, config.firmware, 32);
  registers.set_text(gev::manufacturer_info, "emulation", 48);
  registers.set_text(gev::serial_number, config.serial, 16);
  const std::string url = fmt::format("Local:{};{:X};{:X}", description.genicam.file_name, RegisterMap::xml_address,
                                      description_served().size());
  registers.set_text(gev::first_url, config.description_url.empty() ? url : config.description_url, 512);
  set(gev::network_interfaces, 1);
  set(gev::stream_channels, 1);
  set(gev::gvcp_capability, gev::capabilities);
  set(gev::heartbeat_timeout, static_cast<std::uint32_t>(config.heartbeat_timeout.count()));
  set(gev::tick_frequency_low, 1000000000);
  set(gev::control_privilege, 0);
  set(gev::stream_port, 0);
  set(gev::stream_destination, 0);
  set(gev::stream_packet_size, default_packet_bytes);
  set(gev::stream_packet_delay, 0);
  set(gev::stream_source_port, stream.port());
  next_block_id = config.first_block_id;
  if (config.chunks_at_power_up) set(description.registers.chunk_mode, 1);
  update_payload_size();
  // Until the client selects a video standard, the rate may differ from all standards.
  period_ns = gvsp_period_ns(config.frame_rate_hz);
}

void GvspCamera::State::serve_control(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    // A heartbeat that waited while this thread could not run was in time: received messages are handled first.
    if (const auto request = control.receive(control_patience)) {
      answer(*request, stop);
    } else {
      device.check_heartbeat(Clock::now());
    }
  }
}

void GvspCamera::State::answer(const GvcpDatagram& request, const std::stop_token& stop) {
  {
    std::unique_lock lock(mutex);
    if (Clock::now() < link_down_until || Clock::now() < control_down_until) return;
    // Waits before the answer, but can be switched off at any moment.
    if (config.memory_delay > 0ms && asks_for_memory(request.content))
      changed.wait_for(lock, stop, config.memory_delay, [] { return false; });
  }
  if (const auto reply = device.answer(request.content, request.from, Clock::now())) control.send(*reply, request.from);
}

void GvspCamera::State::on_write(std::uint32_t address, std::uint32_t value) {
  for (const auto& [category, features] : description.genicam.categories) {
    for (const CameraFeature& feature : features)
      if (feature.address == address && feature.name == config.deaf_feature) registers.set(address, feature.initial);
  }
  const ModelRegisters& r = description.registers;
  if (address == r.acquisition_start) {
    registers.lock_transport();
    const std::lock_guard lock(mutex);
    acquiring = true;
    ++acquisitions;
    changed.notify_all();
  } else if (address == r.acquisition_stop) {
    stop_acquisition();
  } else if (address == r.nuc_action) {
    begin_correction(1);
  } else if (r.nuc_action_long != 0 && address == r.nuc_action_long) {
    begin_correction(4);
  } else if (address == r.pixel_format || address == r.chunk_mode) {
    update_payload_size();
  } else if (r.video_standard != 0 && address == r.video_standard && video_standard_hz(value) > 0) {
    const std::lock_guard lock(mutex);
    period_ns = gvsp_period_ns(video_standard_hz(value));
  } else if (address == gev::stream_packet_size && (value & gev::fire_test_packet) != 0) {
    registers.set(address, value & ~gev::fire_test_packet);
    send_test_packet(value & gev::packet_size_mask);
  }
}

void GvspCamera::State::update_payload_size() {
  const ModelRegisters& r = description.registers;
  const auto format = pixel_format_of_pfnc(registers.get(r.pixel_format)).value_or(PixelFormat::mono16);
  const auto image = static_cast<std::uint32_t>(bytes_of_pixels(
      format, static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height + config.rows_not_sent)));
  const auto padding =
      static_cast<std::uint32_t>(config.row_padding_bytes * config.height + config.image_padding_bytes);
  registers.set(r.payload_size, image + padding + (registers.get(r.chunk_mode) != 0 ? chunk_bytes : 0));
}

void GvspCamera::State::on_control_lost() {
  stop_acquisition();
  registers.set(gev::stream_port, 0);
  const std::lock_guard lock(mutex);
  ++counts.controls_lost;
}

void GvspCamera::State::stop_acquisition() {
  registers.unlock_transport();
  const std::lock_guard lock(mutex);
  acquiring = false;
  changed.notify_all();
}

void GvspCamera::State::begin_correction(unsigned times) {
  const std::lock_guard lock(mutex);
  ++counts.corrections;
  frozen_frames = times * static_cast<unsigned>(config.nuc_freeze_frames);
}

void GvspCamera::State::send_test_packet(std::uint32_t packet_bytes) {
  const auto to = destination();
  if (to.port == 0 || packet_bytes < gvsp_least_packet_bytes || link_is_down()) return;
  const Bytes zeros(packet_bytes - gvsp_overhead_bytes);
  GvspPacket packet;
  packet.head_bytes = 8;
  packet.data = zeros;
  const std::lock_guard lock(sending);
  stream.send({&packet, 1}, to, 0ns);
}

}  // namespace todbench
