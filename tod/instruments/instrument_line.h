// What carries bytes to an instrument and back: a TCP socket, a serial port, or VXI-11.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>

#include "acquisition/core/result.h"
#include "tod/instruments/descriptor.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

/// Where an instrument is.
struct InstrumentAddress {
  enum class Kind { tcp, serial, vxi11 };
  Kind kind = Kind::tcp;
  std::string host;
  std::uint16_t port = 0;  ///< of VXI-11: 0 asks the port mapper of the host
  std::string device;      ///< path of a serial port; of VXI-11 the logical instrument, "inst0"
};

/// "HOST:PORT", "[IPv6]:PORT" or "HOST" (then `port`) of an instrument on TCP, "serial:/dev/NAME", or
/// "vxi11:HOST[:PORT][/DEVICE]". `invalid_input` for anything else.
[[nodiscard]] Result<InstrumentAddress> instrument_address(const std::string& text, std::uint16_t port = 5025);

/// An open way to one instrument. It ends when it is destroyed. One thread at a time.
class InstrumentLine {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  virtual ~InstrumentLine() = default;
  /// Sends all of it. Errors: `timeout`, `interrupted`, `disconnected`.
  [[nodiscard]] virtual Result<void> send(std::string_view bytes, TimePoint deadline, const std::stop_token& stop) = 0;
  /// What came, at least one byte. The same errors.
  [[nodiscard]] virtual Result<std::string> receive(TimePoint deadline, const std::stop_token& stop) = 0;
  /// True when a second question before the answer to the first would cancel it (IEEE 488.2, 6.3.2.3: INTERRUPTED).
  [[nodiscard]] virtual bool one_at_a_time() const { return false; }
};

/// Opens the way. Errors: `not_found` (nobody there, no access, no serial port), `timeout` as `not_found`,
/// `interrupted`.
[[nodiscard]] Result<std::unique_ptr<InstrumentLine>> open_line(const InstrumentAddress& address,
                                                                const SerialSettings& serial,
                                                                InstrumentLine::TimePoint deadline,
                                                                const std::stop_token& stop);

/// A connected TCP socket, not blocking.
[[nodiscard]] Result<Descriptor> connect_tcp(const std::string& host, std::uint16_t port,
                                             InstrumentLine::TimePoint deadline, const std::stop_token& stop);
/// Sends all of `bytes` over a descriptor that does not block; a socket raises no signal.
[[nodiscard]] Result<void> send_all(int fd, std::string_view bytes, InstrumentLine::TimePoint deadline,
                                    const std::stop_token& stop);
/// At least one byte, at most 4096.
[[nodiscard]] Result<std::string> receive_some(int fd, InstrumentLine::TimePoint deadline, const std::stop_token& stop);

}  // namespace todbench
