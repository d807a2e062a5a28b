// SPDX-License-Identifier: GPL-3.0-or-later
// Responses of a GigE Vision camera to control messages: privilege, heartbeat, registers. The code uses neither sockets
// nor a clock: messages and times are arguments.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>

#include "sim_devices/lab/gige/gvcp_message.h"
#include "sim_devices/lab/gige/register_map.h"

namespace todbench {

/// Sender of a message.
struct GvcpEndpoint {
  std::uint32_t address = 0;  ///< IPv4, host byte order
  std::uint16_t port = 0;
  bool operator==(const GvcpEndpoint&) const = default;
};

/// Callbacks to the rest of the camera. Called without locks on the thread that calls GvcpDevice.
struct GvcpHandlers {
  std::function<void(std::uint32_t address, std::uint32_t value)> on_write;  ///< after the value is stored
  std::function<void(const ResendRequest&)> on_resend;                       ///< only from the controller's host
  std::function<void()> on_control_lost;  ///< the controller left, or sent no message for the heartbeat timeout
};

/// Control part of a camera. Thread-safe.
class GvcpDevice {
 public:
  using Clock = std::chrono::steady_clock;

  GvcpDevice(RegisterMap& registers, GvcpHandlers handlers) : registers_(registers), handlers_(std::move(handlers)) {}

  /// Returns the response to a datagram; empty if there is none.
  [[nodiscard]] std::optional<Bytes> answer(std::span<const std::uint8_t> datagram, const GvcpEndpoint& from,
                                            Clock::time_point now);
  /// Removes the controller if it sent no message for the heartbeat timeout.
  void check_heartbeat(Clock::time_point now);
  /// Removes the controller without a callback, as a reset does.
  void forget_controller();
  /// Denies control to all clients, as if another program had control. The present controller keeps control.
  void deny_access();
  /// Permits control again.
  void permit_access();

  /// Returns whether a client controls the camera.
  [[nodiscard]] bool controlled() const;
  /// Returns the number of requests with an error response since creation.
  [[nodiscard]] std::uint64_t refused() const;

 private:
  struct Reply {
    GvcpStatus status = GvcpStatus::success;
    Bytes payload = {};
  };
  [[nodiscard]] Reply reply_to(const GvcpRequest& request, const GvcpEndpoint& from);
  [[nodiscard]] Reply read_registers(const GvcpRequest& request) const;
  [[nodiscard]] Reply write_registers(const GvcpRequest& request, const GvcpEndpoint& from);
  [[nodiscard]] Reply read_memory(const GvcpRequest& request) const;
  [[nodiscard]] Reply write_memory(const GvcpRequest& request, const GvcpEndpoint& from);
  [[nodiscard]] GvcpStatus write(std::uint32_t address, std::uint32_t value, const GvcpEndpoint& from);
  [[nodiscard]] GvcpStatus change_privilege(std::uint32_t value, const GvcpEndpoint& from);
  [[nodiscard]] bool is_controller(const GvcpEndpoint& from) const;
  /// Returns whether a sender may request packets again. Any port of the controller's host may do so, because the
  /// requests come from the client's stream socket.
  [[nodiscard]] bool may_ask_again(const GvcpEndpoint& from) const;

  RegisterMap& registers_;
  GvcpHandlers handlers_;
  mutable std::mutex mutex_;  ///< guards all members below
  std::optional<GvcpEndpoint> controller_;
  Clock::time_point last_heard_;
  bool denied_ = false;
  std::uint64_t refused_ = 0;
};

}  // namespace todbench
