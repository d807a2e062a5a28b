// SPDX-License-Identifier: GPL-3.0-or-later
// Transport of bytes to and from an instrument: TCP socket, serial port or VXI-11.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Address of an instrument.
struct InstrumentAddress {
  enum class Kind { tcp, serial, vxi11 };
  Kind kind = Kind::tcp;
  std::string host;
  std::uint16_t port = 0;  ///< 0 for VXI-11: the port mapper of the host is queried
  std::string device;      ///< path of a serial port; for VXI-11 the logical instrument, for example "inst0"
};

/// Parses "HOST:PORT", "[IPv6]:PORT" or "HOST" (with the default `port`) for TCP, "serial:/dev/NAME", or
/// "vxi11:HOST[:PORT][/DEVICE]". Errors: `invalid_input` for any other text.
[[nodiscard]] Result<InstrumentAddress> instrument_address(const std::string& text, std::uint16_t port = 5025);

/// An open connection to one instrument, closed on destruction. One thread at a time.
class InstrumentLine {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  virtual ~InstrumentLine() = default;
  /// Sends all bytes. Errors: `timeout`, `interrupted`, `disconnected`.
  [[nodiscard]] virtual Result<void> send(std::string_view bytes, TimePoint deadline, const std::stop_token& stop) = 0;
  /// Returns the received bytes, at least one. Errors as send().
  [[nodiscard]] virtual Result<std::string> receive(TimePoint deadline, const std::stop_token& stop) = 0;
  /// Returns true if a query must be answered before the next query is sent. Otherwise the next query would cancel the
  /// first query (IEEE 488.2, 6.3.2.3: INTERRUPTED).
  [[nodiscard]] virtual bool one_at_a_time() const { return false; }
};

/// Returns a connected, non-blocking TCP socket. Errors: `not_found` (no connection before `deadline`), `interrupted`.
[[nodiscard]] Result<Descriptor> connect_tcp(const std::string& host, std::uint16_t port,
                                             InstrumentLine::TimePoint deadline, const std::stop_token& stop);
/// Sends all bytes over a non-blocking descriptor, without SIGPIPE. Errors: `timeout`, `interrupted`, `disconnected`.
[[nodiscard]] Result<void> send_all(int fd, std::string_view bytes, InstrumentLine::TimePoint deadline,
                                    const std::stop_token& stop);
/// Receives 1 to 4096 bytes. Errors: `timeout`, `interrupted`, `disconnected`.
[[nodiscard]] Result<std::string> receive_some(int fd, InstrumentLine::TimePoint deadline, const std::stop_token& stop);

}  // namespace todbench
