// SPDX-License-Identifier: GPL-3.0-or-later
// Serial port (the far end of a pseudo-terminal) and VXI-11 for an emulated SCPI instrument, besides the raw socket.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"
#include "sim_devices/lab/instruments/scpi_session.h"

namespace todbench {

/// Serves an instrument on a pseudo-terminal, line by line.
class ScpiSerialPort {
  struct Ends {
    Descriptor ours, theirs;  ///< `theirs` stays open, so that a client that closes the port does not end it
    std::string path;
  };

 public:
  /// `ending`: line ending in both directions. `not_found` if the system has no pseudo-terminal.
  [[nodiscard]] static Result<std::unique_ptr<ScpiSerialPort>> start(ScpiLanguage language, std::string ending = "\n");
  /// For start() only.
  ScpiSerialPort(ScpiLanguage language, std::string ending, Ends ends);
  ScpiSerialPort(const ScpiSerialPort&) = delete;
  ScpiSerialPort& operator=(const ScpiSerialPort&) = delete;
  ~ScpiSerialPort() = default;

  /// "serial:/dev/pts/7".
  [[nodiscard]] std::string address() const { return "serial:" + ends_.path; }

 private:
  const ScpiLanguage language_;
  const std::string ending_;
  const Ends ends_;
  std::jthread thread_;  // last: ends before the members that it uses
};

/// VXI-11 server with a port mapper on the same port of 127.0.0.1, for one client at a time. A read without a pending
/// answer times out at once.
class ScpiVxi11Server {
  struct Listening {
    Descriptor socket;
    std::uint16_t port;
  };

 public:
  [[nodiscard]] static Result<std::unique_ptr<ScpiVxi11Server>> start(ScpiLanguage language);
  /// For start() only.
  ScpiVxi11Server(ScpiLanguage language, Listening listening);
  ScpiVxi11Server(const ScpiVxi11Server&) = delete;
  ScpiVxi11Server& operator=(const ScpiVxi11Server&) = delete;
  ~ScpiVxi11Server() = default;

  [[nodiscard]] std::uint16_t port() const { return listening_.port; }
  /// "vxi11:127.0.0.1:PORT".
  [[nodiscard]] std::string address() const { return "vxi11:127.0.0.1:" + std::to_string(listening_.port); }

 private:
  const ScpiLanguage language_;
  const Listening listening_;
  std::jthread thread_;  // last: ends before the members that it uses
};

}  // namespace todbench
