// The receive buffer of the socket on which a camera's frames arrive.
#pragma once

#include <cstdint>
#include <optional>

namespace todbench {

/// Asks the kernel for `bytes` on this process's UDP socket bound to `local_port` and returns what it granted in bytes:
/// the kernel caps the request silently at net.core.rmem_max. Nothing when no such socket is found (e.g. a packet ring
/// is used instead). Any thread. Aravis applies its own `socket-buffer-size` only when the first packet has arrived and
/// never reads it back; setting it here protects the first frame as well.
[[nodiscard]] std::optional<std::uint64_t> request_socket_buffer(std::uint16_t local_port, std::uint64_t bytes);

}  // namespace todbench
