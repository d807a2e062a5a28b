// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/gvcp_device.h"

#include "acquisition/aravis/gev_registers.h"

namespace todbench {
namespace {

/// Most bytes of a READMEM, so that its acknowledge fits into one packet of 576 bytes.
constexpr std::size_t most_memory_bytes = 536;

}  // namespace

std::optional<Bytes> GvcpDevice::answer(std::span<const std::uint8_t> datagram, const GvcpEndpoint& from,
                                        Clock::time_point now) {
  const auto request = parse_gvcp_request(datagram);
  if (!request) return std::nullopt;
  {
    const std::lock_guard lock(mutex_);
    if (controller_ == from) last_heard_ = now;
  }
  if (request->command == static_cast<std::uint16_t>(GvcpCommand::packet_resend)) {
    const auto resend = parse_resend_request(request->payload);
    if (resend && may_ask_again(from) && handlers_.on_resend) handlers_.on_resend(*resend);
    return std::nullopt;  // the packets are the answer
  }
  const Reply reply = reply_to(*request, from);
  {
    const std::lock_guard lock(mutex_);
    if (reply.status != GvcpStatus::success) ++refused_;
    // The first message of a new controller counts as its heartbeat.
    if (controller_ == from) last_heard_ = now;
  }
  if (!request->wants_acknowledge) return std::nullopt;
  return gvcp_acknowledge(*request, reply.status, reply.payload);
}

GvcpDevice::Reply GvcpDevice::reply_to(const GvcpRequest& request, const GvcpEndpoint& from) {
  switch (static_cast<GvcpCommand>(request.command)) {
    case GvcpCommand::discovery: {
      auto identity = registers_.read(0, gev::discovery_bytes);
      if (!identity) return {.status = identity.error()};
      return {.payload = std::move(*identity)};
    }
    case GvcpCommand::read_register:
      return read_registers(request);
    case GvcpCommand::write_register:
      return write_registers(request, from);
    case GvcpCommand::read_memory:
      return read_memory(request);
    case GvcpCommand::write_memory:
      return write_memory(request, from);
    default:
      return {.status = GvcpStatus::not_implemented};
  }
}

GvcpDevice::Reply GvcpDevice::read_registers(const GvcpRequest& request) const {
  if (request.payload.empty() || request.payload.size() % 4 != 0) return {.status = GvcpStatus::invalid_parameter};
  Reply reply;
  for (std::size_t at = 0; at < request.payload.size(); at += 4) {
    const auto word = registers_.read(static_cast<std::uint32_t>(big_endian_at(request.payload, at, 4)), 4);
    if (!word) {
      reply.status = word.error();
      break;
    }
    reply.payload.insert(reply.payload.end(), word->begin(), word->end());
  }
  return reply;
}

GvcpDevice::Reply GvcpDevice::write_registers(const GvcpRequest& request, const GvcpEndpoint& from) {
  if (request.payload.empty() || request.payload.size() % 8 != 0) return {.status = GvcpStatus::invalid_parameter};
  Reply reply;
  std::size_t written = 0;
  for (std::size_t at = 0; at < request.payload.size() && reply.status == GvcpStatus::success; at += 8) {
    reply.status = write(static_cast<std::uint32_t>(big_endian_at(request.payload, at, 4)),
                         static_cast<std::uint32_t>(big_endian_at(request.payload, at + 4, 4)), from);
    if (reply.status == GvcpStatus::success) ++written;
  }
  append_big_endian(reply.payload, written, 4);
  return reply;
}

GvcpDevice::Reply GvcpDevice::read_memory(const GvcpRequest& request) const {
  if (request.payload.size() != 8) return {.status = GvcpStatus::invalid_parameter};
  const auto bytes = static_cast<std::size_t>(big_endian_at(request.payload, 6, 2));
  if (bytes == 0 || bytes > most_memory_bytes) return {.status = GvcpStatus::invalid_parameter};
  auto content = registers_.read(static_cast<std::uint32_t>(big_endian_at(request.payload, 0, 4)), bytes);
  if (!content) return {.status = content.error()};
  Reply reply;
  reply.payload.assign(request.payload.begin(), request.payload.begin() + 4);
  reply.payload.insert(reply.payload.end(), content->begin(), content->end());
  return reply;
}

GvcpDevice::Reply GvcpDevice::write_memory(const GvcpRequest& request, const GvcpEndpoint& from) {
  if (request.payload.size() < 8 || request.payload.size() % 4 != 0) return {.status = GvcpStatus::invalid_parameter};
  const auto address = static_cast<std::uint32_t>(big_endian_at(request.payload, 0, 4));
  Reply reply;
  std::size_t written = 0;
  for (std::size_t at = 4; at < request.payload.size() && reply.status == GvcpStatus::success; at += 4) {
    reply.status = write(address + static_cast<std::uint32_t>(at) - 4,
                         static_cast<std::uint32_t>(big_endian_at(request.payload, at, 4)), from);
    if (reply.status == GvcpStatus::success) written += 4;
  }
  append_big_endian(reply.payload, written, 4);
  return reply;
}

GvcpStatus GvcpDevice::write(std::uint32_t address, std::uint32_t value, const GvcpEndpoint& from) {
  if (address == gev::control_privilege) return change_privilege(value, from);
  if (!is_controller(from)) return GvcpStatus::access_denied;
  const auto status = registers_.write(address, value);
  if (status == GvcpStatus::success && handlers_.on_write) handlers_.on_write(address, value);
  return status;
}

GvcpStatus GvcpDevice::change_privilege(std::uint32_t value, const GvcpEndpoint& from) {
  const bool wants_control = (value & (gev::exclusive_access | gev::control_access)) != 0;
  bool released = false;
  {
    const std::lock_guard lock(mutex_);
    if (controller_ && controller_ != from) return GvcpStatus::access_denied;
    if (wants_control && denied_ && !controller_) return GvcpStatus::access_denied;
    released = controller_.has_value() && !wants_control;
    controller_ = wants_control ? std::optional(from) : std::nullopt;
    registers_.set(gev::control_privilege, value);
  }
  if (released && handlers_.on_control_lost) handlers_.on_control_lost();
  return GvcpStatus::success;
}

void GvcpDevice::check_heartbeat(Clock::time_point now) {
  {
    const std::lock_guard lock(mutex_);
    const std::chrono::milliseconds timeout(registers_.get(gev::heartbeat_timeout));
    if (!controller_ || now - last_heard_ < timeout) return;
    controller_.reset();
    registers_.set(gev::control_privilege, 0);
  }
  if (handlers_.on_control_lost) handlers_.on_control_lost();
}

void GvcpDevice::forget_controller() {
  const std::lock_guard lock(mutex_);
  controller_.reset();
  registers_.set(gev::control_privilege, 0);
}

void GvcpDevice::deny_access() {
  const std::lock_guard lock(mutex_);
  denied_ = true;
  // For a client that reads the register before it tries.
  if (!controller_) registers_.set(gev::control_privilege, gev::control_access);
}

void GvcpDevice::permit_access() {
  const std::lock_guard lock(mutex_);
  denied_ = false;
  if (!controller_) registers_.set(gev::control_privilege, 0);
}

bool GvcpDevice::is_controller(const GvcpEndpoint& from) const {
  const std::lock_guard lock(mutex_);
  return controller_ == from;
}

bool GvcpDevice::may_ask_again(const GvcpEndpoint& from) const {
  const std::lock_guard lock(mutex_);
  return controller_ && controller_->address == from.address;
}

bool GvcpDevice::controlled() const {
  const std::lock_guard lock(mutex_);
  return controller_.has_value();
}

std::uint64_t GvcpDevice::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

}  // namespace todbench
