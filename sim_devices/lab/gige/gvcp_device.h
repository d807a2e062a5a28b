// How a GigE Vision camera answers control messages: privilege, heartbeat, registers. No sockets and no clock: what
// comes in and when are arguments.
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

/// Where a message came from.
struct GvcpEndpoint {
  std::uint32_t address = 0;  ///< IPv4, host byte order
  std::uint16_t port = 0;
  bool operator==(const GvcpEndpoint&) const = default;
};

/// What the rest of a camera does about messages. Called on the thread that calls GvcpDevice, without locks.
struct GvcpHandlers {
  std::function<void(std::uint32_t address, std::uint32_t value)> on_write;  ///< after it was stored
  std::function<void(const ResendRequest&)> on_resend;                       ///< from the controller's host only
  std::function<void()> on_control_lost;  ///< the controller went, or was silent for the heartbeat timeout
};

/// Thread-safe.
class GvcpDevice {
 public:
  using Clock = std::chrono::steady_clock;

  GvcpDevice(RegisterMap& registers, GvcpHandlers handlers) : registers_(registers), handlers_(std::move(handlers)) {}

  /// The answer to a datagram; nothing when there is none.
  [[nodiscard]] std::optional<Bytes> answer(std::span<const std::uint8_t> datagram, const GvcpEndpoint& from,
                                            Clock::time_point now);
  /// Ends the control of a client that has been silent for the heartbeat timeout.
  void check_heartbeat(Clock::time_point now);
  /// Forgets the controller without telling anybody, as a reset does.
  void forget_controller();
  /// From now on nobody gets control, as if another program had it; whoever has it keeps it.
  void deny_access();
  void permit_access();

  [[nodiscard]] bool controlled() const;
  /// Requests that were answered with an error, since the beginning.
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
  /// Requests for packets come from the socket that receives them, not from the controller's.
  [[nodiscard]] bool may_ask_again(const GvcpEndpoint& from) const;

  RegisterMap& registers_;
  GvcpHandlers handlers_;
  mutable std::mutex mutex_;  ///< guards what follows
  std::optional<GvcpEndpoint> controller_;
  Clock::time_point last_heard_;
  bool denied_ = false;
  std::uint64_t refused_ = 0;
};

}  // namespace todbench
