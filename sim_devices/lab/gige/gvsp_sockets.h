// SPDX-License-Identifier: GPL-3.0-or-later
// Sockets of an emulated GigE Vision camera.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"
#include "sim_devices/lab/gige/gvcp_device.h"
#include "sim_devices/lab/gige/gvsp_packets.h"

namespace todbench {

/// Interface of this host.
struct LocalInterface {
  int index = 0;                        ///< number of the interface in the system
  std::uint32_t address = 0, mask = 0;  ///< host byte order
};
/// Returns the interface that is up and has this address; empty if there is none.
[[nodiscard]] std::optional<LocalInterface> find_interface(const std::string& ipv4);

/// Message and its sender.
struct GvcpDatagram {
  Bytes content;
  GvcpEndpoint from;
};

/// Control port of a camera: receives on its own address, and broadcasts on its interface.
class ControlSockets {
 public:
  /// Opens the sockets. Errors: `not_found` (port busy).
  [[nodiscard]] static Result<ControlSockets> open(const LocalInterface& where);
  /// Returns the next message; empty if none arrives within `patience` or if wake() is called.
  [[nodiscard]] std::optional<GvcpDatagram> receive(std::chrono::milliseconds patience);
  void send(std::span<const std::uint8_t> datagram, const GvcpEndpoint& to);
  /// Ends a waiting receive(); any thread.
  void wake();

 private:
  ControlSockets() = default;
  int interface_ = 0;
  Descriptor own_, broadcast_, wake_;
};

/// Socket that sends frames.
class StreamSocket {
 public:
  /// Opens a socket at `address` (host byte order), any port. Errors: `not_found`.
  [[nodiscard]] static Result<StreamSocket> open(std::uint32_t address);
  /// Sends the packets in order with `pause` between packets. Any thread, one call at a time.
  void send(std::span<const GvspPacket> packets, const GvcpEndpoint& to, std::chrono::nanoseconds pause);
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  StreamSocket() = default;
  Descriptor socket_;
  std::uint16_t port_ = 0;
};

}  // namespace todbench
