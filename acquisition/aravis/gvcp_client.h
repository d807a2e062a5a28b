// SPDX-License-Identifier: GPL-3.0-or-later
// GigE Vision control messages with a time limit: reads registers and texts over a plain UDP socket. Source: GigE
// Vision 2.0, chapter "GVCP"; the key byte is 0x42, and an acknowledge code is the command code + 1.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "acquisition/aravis/gev_registers.h"
#include "acquisition/base/result.h"

namespace todbench {

/// UDP port of every GigE Vision device; fixed by the standard.
inline constexpr std::uint16_t gvcp_port = 3956;
/// Version register. Every device answers any client that reads it, without side effects.
inline constexpr std::uint32_t gvcp_version_register = gev::version;
/// Control channel privilege: not zero while a client controls the device. Do not poll it, because some devices
/// interpret this read as the heartbeat of the controller.
inline constexpr std::uint32_t gvcp_control_privilege_register = gev::control_privilege;

/// Reads a 32-bit register of the device at `ipv4`; needs no control privilege. Repeats the request every 50 ms and
/// blocks for at most `patience`. Any thread. Errors: `timeout` (no answer), `not_found` (not an IPv4 address, no
/// socket, the device refuses the address).
[[nodiscard]] Result<std::uint32_t> gvcp_read_register(const std::string& ipv4, std::uint32_t address,
                                                       std::chrono::milliseconds patience);

/// Reads a text of at most `bytes` (a multiple of 4, up to 536) from the memory. Errors as gvcp_read_register().
[[nodiscard]] Result<std::string> gvcp_read_text(const std::string& ipv4, std::uint32_t address, std::uint16_t bytes,
                                                 std::chrono::milliseconds patience);

/// Limits and progress of a long read.
struct GvcpReading {
  std::chrono::milliseconds patience{30'000};  ///< time limit of the whole read
  std::stop_token stop = {};
  std::function<void(std::uint64_t bytes)> on_bytes = {};  ///< bytes read so far; called on the reading thread
};

/// Reads `bytes` of the device's memory, 512 at a time, from an address that is a multiple of 4. Errors: as
/// gvcp_read_register(), but `not_found` with the progress if `patience` expires; `interrupted`.
[[nodiscard]] Result<std::string> gvcp_read_memory(const std::string& ipv4, std::uint32_t address, std::uint32_t bytes,
                                                   const GvcpReading& reading);

}  // namespace todbench
