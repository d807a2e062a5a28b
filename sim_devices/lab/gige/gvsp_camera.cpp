// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/gvsp_camera.h"

#include <utility>

#include "acquisition/base/try.h"
#include "sim_devices/lab/gige/gvsp_camera_state.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

Result<void> validate(const GvspCameraConfig& c) {
  const auto bad = [](const std::string& what) { return fail(ErrorCode::invalid_input, "emulated camera: " + what); };
  TODBENCH_TRY_VOID(validate_emulation("emulated camera", c));
  if (c.width < 8 || c.height < 2) return bad("the picture must be 8 x 2 ... 4096 x 4096");
  if (c.serial.size() > 15) return bad("serial must have 1 ... 15 characters");
  if (c.vendor.size() > 31 || c.model_name.size() > 31 || c.firmware.size() > 31) {
    return bad("vendor, model and firmware must have at most 31 characters");
  }
  if (c.row_padding_bytes < 0 || c.row_padding_bytes > 65535 || c.image_padding_bytes < 0 ||
      c.image_padding_bytes > 65535) {
    return bad("padding must be 0 ... 65535 bytes");
  }
  if (c.first_block_id == 0) return bad("first_block_id must not be 0");
  return {};
}

ModelDescription described(const GvspCameraConfig& c) {
  return describe_camera(c.model, {.vendor = c.vendor,
                                   .model = c.model_name,
                                   .serial = c.serial,
                                   .firmware = c.firmware,
                                   .width = c.width,
                                   .height = c.height + c.rows_not_sent,
                                   .significant_bits = c.significant_bits,
                                   .frame_rate_hz = c.frame_rate_hz,
                                   .only_format = c.only_format});
}

}  // namespace

GvspCamera::State::State(GvspCameraConfig c, Exposure e, ControlSockets control_sockets, StreamSocket stream_socket,
                         const LocalInterface& where)
    : config(std::move(c)),
      exposure(std::move(e)),
      description(described(config)),
      interface(where),
      control(std::move(control_sockets)),
      stream(std::move(stream_socket)),
      registers(description.genicam, description_served()),
      device(registers, {.on_write = [this](std::uint32_t a, std::uint32_t v) { on_write(a, v); },
                         .on_resend = [this](const ResendRequest& r) { resend(r); },
                         .on_control_lost = [this] { on_control_lost(); }}),
      encoder(config.kelvin_per_count, config.offset_k, config.radiometric),
      random(config.seed, "gvsp.faults") {
  power_up();
}

std::string GvspCamera::State::description_served() const {
  return config.description.empty() ? genicam_xml(description.genicam) : config.description;
}

GvspCamera::GvspCamera(std::unique_ptr<State> state) : state_(std::move(state)) {}

GvspCamera::~GvspCamera() {
  state_->control_thread.request_stop();
  state_->stream_thread.request_stop();
  state_->control.wake();
}

Result<std::unique_ptr<GvspCamera>> GvspCamera::start(GvspCameraConfig config, Exposure exposure) {
  TODBENCH_TRY_VOID(validate(config));
  if (!exposure) return fail(ErrorCode::invalid_input, "emulated camera: the exposure function is missing");
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

void GvspCamera::restart_numbers(std::uint16_t block_id, ClockRestart clock) {
  const std::lock_guard lock(state_->mutex);
  state_->next_block_id = block_id;
  if (clock == ClockRestart::begins_anew) state_->clock_ns = 0;
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
