// The sockets of an emulated GigE Vision camera.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "acquisition/core/result.h"
#include "sim_devices/lab/gige/gvcp_device.h"
#include "sim_devices/lab/gige/gvsp_packets.h"

namespace todbench {

/// A file descriptor with one owner.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&& other) noexcept;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_ = -1;
};

/// An interface of this host.
struct NetworkInterface {
  int index = 0;
  std::uint32_t address = 0, mask = 0;  ///< host byte order
};
/// The interface that is up and has this address; nothing when there is none.
[[nodiscard]] std::optional<NetworkInterface> find_interface(const std::string& ipv4);

/// A message with where it came from.
struct GvcpDatagram {
  Bytes content;
  GvcpEndpoint from;
};

/// The control port of a camera: its own address, and broadcasts that arrive on its interface.
class ControlSockets {
 public:
  /// Errors: `not_found` (port busy).
  [[nodiscard]] static Result<ControlSockets> open(const NetworkInterface& where);
  /// The next message; nothing when none comes within `patience` or wake() is called.
  [[nodiscard]] std::optional<GvcpDatagram> receive(std::chrono::milliseconds patience);
  void send(std::span<const std::uint8_t> datagram, const GvcpEndpoint& to);
  /// Ends a waiting receive(); any thread.
  void wake();

 private:
  ControlSockets() = default;
  int interface_ = 0;
  Socket own_, broadcast_, wake_;
};

/// Where frames go out.
class StreamSocket {
 public:
  [[nodiscard]] static Result<StreamSocket> open(std::uint32_t address);
  /// Sends in this order, `pause` between two; any thread, one at a time.
  void send(std::span<const GvspPacket> packets, const GvcpEndpoint& to, std::chrono::nanoseconds pause);
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  StreamSocket() = default;
  Socket socket_;
  std::uint16_t port_ = 0;
};

}  // namespace todbench
