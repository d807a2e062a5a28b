#include "sim_devices/lab/gvsp_camera.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "sim_devices/lab/gev_registers.h"
#include "sim_devices/lab/gvcp_device.h"
#include "sim_devices/lab/gvsp_sockets.h"
#include "sim_devices/lab/picture_encoder.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Frames that a camera keeps for packets that are asked for again.
constexpr std::size_t kept_frames = 8;
/// How often the heartbeat is looked at.
constexpr auto control_patience = 50ms;
/// A camera that fell behind by more than this goes on from now instead of catching up.
constexpr auto most_lag = 250ms;
/// What chunk mode adds to an image: four chunks with id and length, with contents of 8, 4 and 4 bytes beside the
/// image.
constexpr std::uint32_t chunk_bytes = 4 * 8 + 8 + 4 + 4;
constexpr std::uint32_t default_packet_bytes = 1400;
constexpr std::uint32_t least_packet_bytes = 46;

Result<void> validate(const GvspCameraConfig& c) {
  const auto bad = [](const std::string& what) { return fail(ErrorCode::invalid_input, "emulated camera: " + what); };
  if (c.width < 8 || c.height < 2 || c.width > 4096 || c.height > 4096)
    return bad("the picture must be 8 x 2 ... 4096 x 4096");
  if (c.significant_bits < 8 || c.significant_bits > 16) return bad("significant_bits must be 8 ... 16");
  if (!(c.frame_rate_hz >= 0.1 && c.frame_rate_hz <= 1000)) return bad("frame_rate_hz must be 0.1 ... 1000");
  if (!(c.kelvin_per_count > 0) || !std::isfinite(c.offset_k)) return bad("kelvin_per_count must be positive");
  if (c.serial.empty() || c.serial.size() > 15) return bad("serial must have 1 ... 15 characters");
  if (c.vendor.size() > 31 || c.model_name.size() > 31 || c.firmware.size() > 31) {
    return bad("vendor, model and firmware must have at most 31 characters");
  }
  if (c.first_block_id == 0) return bad("block id 0 does not exist");
  if (c.nuc_freeze_frames < 0) return bad("nuc_freeze_frames must not be negative");
  return {};
}

ModelDescription described(const GvspCameraConfig& c) {
  return describe_camera(c.model, {.vendor = c.vendor,
                                   .model = c.model_name,
                                   .serial = c.serial,
                                   .firmware = c.firmware,
                                   .width = c.width,
                                   .height = c.height,
                                   .significant_bits = c.significant_bits,
                                   .frame_rate_hz = c.frame_rate_hz});
}

/// In whole microseconds, as exposure_index() assumes.
std::uint64_t period_of(double rate_hz) {
  return 1000 * static_cast<std::uint64_t>(std::lround(1e6 / rate_hz));
}

}  // namespace

struct GvspCamera::State {
  State(GvspCameraConfig c, Exposure e, ControlSockets control_sockets, StreamSocket stream_socket,
        const NetworkInterface& where)
      : config(std::move(c)),
        exposure(std::move(e)),
        description(described(config)),
        interface(where),
        control(std::move(control_sockets)),
        stream(std::move(stream_socket)),
        registers(description.genicam, genicam_xml(description.genicam)),
        device(registers, {.on_write = [this](std::uint32_t a, std::uint32_t v) { on_write(a, v); },
                           .on_resend = [this](const ResendRequest& r) { resend(r); },
                           .on_control_lost = [this] { on_control_lost(); }}),
        encoder(config.kelvin_per_count, config.offset_k, config.radiometric),
        random(config.seed, "gvsp.faults") {
    power_up();
  }

  const GvspCameraConfig config;
  const Exposure exposure;
  const ModelDescription description;
  const NetworkInterface interface;
  ControlSockets control;
  StreamSocket stream;
  std::mutex sending;  ///< one sender on `stream` at a time; no other lock is taken under it
  RegisterMap registers;
  GvcpDevice device;
  PictureEncoder encoder;  ///< of the streaming thread
  Bytes last_picture;      ///< of the streaming thread
  const RandomStream random;

  std::mutex mutex;  ///< guards what follows
  std::condition_variable_any changed;
  bool acquiring = false;
  std::uint64_t clock_ns = 0;
  std::uint64_t period_ns = 0;
  std::uint16_t next_block_id = 1;
  unsigned frozen_frames = 0;
  GvspFaults faults;
  GvspCameraCounts counts;
  std::deque<std::shared_ptr<const GvspFrame>> kept;
  Clock::time_point link_down_until, control_down_until;
  std::uint64_t resend_draws = 0;

  std::jthread control_thread, stream_thread;  ///< last members: they stop before anything that they use goes

  void power_up();
  void serve_control(const std::stop_token& stop);
  void serve_stream(const std::stop_token& stop);
  void on_write(std::uint32_t address, std::uint32_t value);
  void on_control_lost();
  void begin_correction(unsigned times);
  void stop_acquisition();
  void send_test_packet(std::uint32_t packet_bytes);
  void resend(const ResendRequest& request);
  [[nodiscard]] EncoderSettings encoder_settings() const;
  void update_payload_size();
  [[nodiscard]] GvcpEndpoint destination() const {
    return {registers.get(gev::stream_destination), static_cast<std::uint16_t>(registers.get(gev::stream_port))};
  }
  [[nodiscard]] bool link_is_down() {
    const std::lock_guard lock(mutex);
    return Clock::now() < link_down_until;
  }

  struct Exposed {
    std::uint64_t index = 0, timestamp_ns = 0;
    std::uint16_t block_id = 1;
    bool shutter_closed = false;
    FrameFaults planned;
    GvspFaults faults;
  };
  [[nodiscard]] Exposed begin_exposure();
  [[nodiscard]] Bytes picture_of(const Exposed& exposed, const EncoderSettings& settings);
  [[nodiscard]] std::shared_ptr<const GvspFrame> frame_of(const Exposed& exposed);
  void send_frame(const GvspFrame& frame, const Exposed& exposed);
};

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
  char url[128];
  std::snprintf(url, sizeof url, "Local:%s;%X;%zX", description.genicam.file_name.c_str(), RegisterMap::xml_address,
                genicam_xml(description.genicam).size());
  registers.set_text(gev::first_url, url, 512);
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
  // Until the client chooses a video standard, the rate may be one that no standard has.
  period_ns = period_of(config.frame_rate_hz);
}

void GvspCamera::State::serve_control(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto request = control.receive(control_patience);
    device.check_heartbeat(Clock::now());
    if (!request) continue;
    {
      const std::lock_guard lock(mutex);
      if (Clock::now() < link_down_until || Clock::now() < control_down_until) continue;
    }
    if (const auto answer = device.answer(request->content, request->from, Clock::now())) {
      control.send(*answer, request->from);
    }
  }
}

void GvspCamera::State::on_write(std::uint32_t address, std::uint32_t value) {
  const ModelRegisters& r = description.registers;
  if (address == r.acquisition_start) {
    registers.lock_transport();
    const std::lock_guard lock(mutex);
    acquiring = true;
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
    period_ns = period_of(video_standard_hz(value));
  } else if (address == gev::stream_packet_size && (value & gev::fire_test_packet) != 0) {
    registers.set(address, value & ~gev::fire_test_packet);
    send_test_packet(value & gev::packet_size_mask);
  }
}

void GvspCamera::State::update_payload_size() {
  const ModelRegisters& r = description.registers;
  const std::uint32_t bytes_per_pixel = registers.get(r.pixel_format) == pfnc_mono8 ? 1 : 2;
  const auto image = bytes_per_pixel * static_cast<std::uint32_t>(config.width * config.height);
  registers.set(r.payload_size, image + (registers.get(r.chunk_mode) != 0 ? chunk_bytes : 0));
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
  if (to.port == 0 || packet_bytes < least_packet_bytes || link_is_down()) return;
  const Bytes zeros(packet_bytes - gvsp_overhead_bytes);
  GvspPacket packet;
  packet.head_bytes = 8;
  packet.data = zeros;
  const std::lock_guard lock(sending);
  stream.send({&packet, 1}, to, 0ns);
}

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
  const auto format = value(r.pixel_format);
  s.bits_per_pixel = format == pfnc_mono8 ? 8 : 16;
  s.significant_bits = static_cast<unsigned>(config.significant_bits);
  if (format == pfnc_mono14) s.significant_bits = std::min(s.significant_bits, 14U);
  if (r.temperature_linear_mode != 0) {
    s.signal = value(r.temperature_linear_mode) != 0 ? SignalKind::linear : SignalKind::radiometric;
    s.kelvin_per_signal = value(r.temperature_linear_resolution) != 0 ? 0.04 : 0.4;
  } else if (r.ir_format != 0) {
    const auto ir_format = value(r.ir_format);
    s.signal = ir_format == 0 ? SignalKind::radiometric : SignalKind::linear;
    s.kelvin_per_signal = ir_format == 2 ? 0.01 : 0.1;
  }
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
  counts.faults.late_leaders += out.planned.late_leader ? 1 : 0;
  return out;
}

Bytes GvspCamera::State::picture_of(const Exposed& exposed, const EncoderSettings& settings) {
  if ((exposed.shutter_closed || exposed.planned.frozen) && !last_picture.empty()) return last_picture;
  cv::Mat1w counts_of_exposure;
  try {
    counts_of_exposure = exposure(exposed.index);
  } catch (...) {
    // A thread must not end here; the owner sees the count.
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
      std::max(registers.get(gev::stream_packet_size) & gev::packet_size_mask, least_packet_bytes);
  frame->bytes_per_packet = packet_bytes - gvsp_overhead_bytes;
  frame->data = picture_of(exposed, settings);
  if (exposed.planned.swapped_bytes && settings.bits_per_pixel == 16) swap_bytes(frame->data);
  if (exposed.planned.wrong_size) {
    const std::size_t row_bytes = frame->data.size() / frame->height;
    frame->height /= 2;
    frame->data.resize(row_bytes * frame->height);
  }
  if (registers.get(description.registers.chunk_mode) == 0) return frame;
  frame->payload_type = 0x4001;
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

GvspCamera::GvspCamera(std::unique_ptr<State> state) : state_(std::move(state)) {}

GvspCamera::~GvspCamera() {
  state_->control_thread.request_stop();
  state_->stream_thread.request_stop();
  state_->control.wake();
}

Result<std::unique_ptr<GvspCamera>> GvspCamera::start(GvspCameraConfig config, Exposure exposure) {
  if (const auto valid = validate(config); !valid) return tl::unexpected(valid.error());
  if (!exposure) return fail(ErrorCode::invalid_input, "emulated camera: there is nothing to expose");
  const auto where = find_interface(config.interface_address);
  if (!where) {
    return fail(ErrorCode::not_found,
                "emulated camera: no interface with address " + config.interface_address + " is up");
  }
  auto control = ControlSockets::open(*where);
  if (!control) return fail("emulated camera at " + config.interface_address, control.error());
  auto stream = StreamSocket::open(where->address);
  if (!stream) return fail("emulated camera at " + config.interface_address, stream.error());
  auto state =
      std::make_unique<State>(std::move(config), std::move(exposure), std::move(*control), std::move(*stream), *where);
  state->control_thread = std::jthread([raw = state.get()](const std::stop_token& stop) { raw->serve_control(stop); });
  state->stream_thread = std::jthread([raw = state.get()](const std::stop_token& stop) { raw->serve_stream(stop); });
  return std::unique_ptr<GvspCamera>(new GvspCamera(std::move(state)));
}

const GvspCameraConfig& GvspCamera::config() const {
  return state_->config;
}

GvspCameraCounts GvspCamera::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

bool GvspCamera::controlled() const {
  return state_->device.controlled();
}

std::uint32_t GvspCamera::register_value(std::uint32_t address) const {
  return state_->registers.get(address);
}

void GvspCamera::set_faults(const GvspFaults& faults) {
  const std::lock_guard lock(state_->mutex);
  state_->faults = faults;
}

void GvspCamera::freeze(unsigned frames) {
  const std::lock_guard lock(state_->mutex);
  state_->frozen_frames = frames;
}

void GvspCamera::pull_cable(std::chrono::milliseconds time) {
  const std::lock_guard lock(state_->mutex);
  state_->link_down_until = Clock::now() + time;
}

void GvspCamera::lose_control_messages(std::chrono::milliseconds time) {
  const std::lock_guard lock(state_->mutex);
  state_->control_down_until = Clock::now() + time;
}

void GvspCamera::reset(std::chrono::milliseconds off) {
  pull_cable(off);
  state_->stop_acquisition();
  state_->device.forget_controller();
  const std::lock_guard lock(state_->mutex);
  state_->power_up();
  state_->frozen_frames = 0;
  state_->kept.clear();
}

void GvspCamera::deny_access() {
  state_->device.deny_access();
}

void GvspCamera::permit_access() {
  state_->device.permit_access();
}

}  // namespace todbench
