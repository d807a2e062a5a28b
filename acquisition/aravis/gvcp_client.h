// GigE Vision control messages that must not wait for anybody: reading a register or a text, over a plain UDP socket.
// Source: GigE Vision 2.0, chapter "GVCP"; key byte 0x42, acknowledge = command + 1.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "acquisition/aravis/gev_registers.h"
#include "acquisition/core/result.h"

namespace todbench {

/// UDP port of every GigE Vision device; fixed by the standard.
inline constexpr std::uint16_t gvcp_port = 3956;
/// Version register: every device answers a read of it, from any client, without side effect.
inline constexpr std::uint32_t gvcp_version_register = gev::version;
/// Control channel privilege: not zero while a client controls the device. Not for polling: some devices take a read of
/// it for the controller's heartbeat.
inline constexpr std::uint32_t gvcp_control_privilege_register = gev::control_privilege;

/// Reads a 32-bit register of the device at `ipv4` without being its controller. Repeats the request every 50 ms until
/// `patience` has passed. Blocks for `patience` at most; needs no privilege; any thread. Errors: `timeout` (no answer),
/// `not_found` (not an IPv4 address, no socket, the device refuses the address).
[[nodiscard]] Result<std::uint32_t> gvcp_read_register(const std::string& ipv4, std::uint32_t address,
                                                       std::chrono::milliseconds patience);

/// Reads the text in at most `bytes` (a multiple of 4, up to 536) bytes of the device's memory, in the same way.
[[nodiscard]] Result<std::string> gvcp_read_text(const std::string& ipv4, std::uint32_t address, std::uint16_t bytes,
                                                 std::chrono::milliseconds patience);

/// How a long reading may go on.
struct GvcpReading {
  std::chrono::milliseconds patience{30'000};  ///< for the whole
  std::stop_token stop = {};
  std::function<void(std::uint64_t bytes)> on_bytes = {};  ///< read so far; in between, on the calling thread
};

/// Reads `bytes` of the device's memory, from an address that is a multiple of 4, 512 at a time. Errors: as above;
/// `not_found` also where patience has ended, with how far it came; `interrupted`.
[[nodiscard]] Result<std::string> gvcp_read_memory(const std::string& ipv4, std::uint32_t address, std::uint32_t bytes,
                                                   const GvcpReading& reading);

}  // namespace todbench
