// SPDX-License-Identifier: GPL-3.0-or-later
// Receive buffer of the socket on which a camera's frames arrive.
#pragma once

#include <cstdint>
#include <optional>

namespace todbench {

/// Requests `bytes` from the kernel for this process's UDP socket bound to `local_port` and returns the granted size in
/// bytes: the kernel silently caps the request at net.core.rmem_max. Empty if there is no such socket (e.g. a packet
/// ring is used instead). Any thread. Aravis applies its own `socket-buffer-size` only after the first packet and never
/// reads it back; this call protects the first frame as well.
[[nodiscard]] std::optional<std::uint64_t> request_socket_buffer(std::uint16_t local_port, std::uint64_t bytes);

}  // namespace todbench
