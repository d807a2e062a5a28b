// SPDX-License-Identifier: GPL-3.0-or-later
// Receive buffer of the socket on which a camera's frames arrive.
#pragma once

#include <cstdint>
#include <optional>

namespace todbench {

/// Requests a receive buffer of `bytes` for the UDP socket of this process at `local_port`. Returns the granted size in
/// bytes; the kernel silently limits it to net.core.rmem_max. Empty if there is no such socket (e.g. a packet ring is
/// used instead). Any thread. Aravis applies its option `socket-buffer-size` only after the first packet and never
/// reads the size back. This call also protects the first frame.
[[nodiscard]] std::optional<std::uint64_t> request_socket_buffer(std::uint16_t local_port, std::uint64_t bytes);

}  // namespace todbench
