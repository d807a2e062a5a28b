// Other ways to an emulated SCPI instrument than a raw socket: a serial port (the far end of a pseudo-terminal) and
// VXI-11.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "acquisition/core/result.h"
#include "sim_devices/lab/instruments/scpi_session.h"
#include "tod/instruments/descriptor.h"

namespace todbench {

/// What a pseudo-terminal hears, executed line by line; what it answers.
class ScpiSerialPort {
  struct Ends {
    Descriptor ours, theirs;  ///< theirs is kept open, so that a client that closes the port does not end it
    std::string path;
  };

 public:
  /// `ending` is that of lines in both directions. `not_found` where the system has no pseudo-terminal.
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
  std::jthread thread_;  // last: ends before what it uses
};

/// A VXI-11 server with a port mapper beside it on one port of 127.0.0.1; one client after the other. A read without an
/// answer to give is a timeout at once.
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
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace todbench
