// SPDX-License-Identifier: GPL-3.0-or-later
// Network part of an emulated SCPI instrument: one message per line over TCP.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"
#include "sim_devices/lab/instruments/scpi_session.h"

namespace todbench {

/// Options of the server.
struct ScpiServerOptions {
  std::string address = "127.0.0.1";  ///< IPv4 address to listen on
  std::uint16_t port = 0;             ///< 0: the system chooses
  std::size_t longest_message = 512;  ///< characters; a longer line is skipped to its end and reported as -363
  std::size_t most_clients = 8;       ///< a further client is disconnected immediately
  /// Number of unread characters of responses after which a client is disconnected.
  std::size_t most_unread = 64 * 1024;
};

/// Server of one instrument, with its own thread, from start() to destruction. Commands of all clients run on this
/// thread, one at a time. All received bytes are untrusted: the options limit the memory per client.
class ScpiServer {
  struct Listening {
    Descriptor socket;
    std::uint16_t port;
  };

 public:
  /// Starts the server. Errors: `not_found` if it cannot listen on the address.
  [[nodiscard]] static Result<std::unique_ptr<ScpiServer>> start(ScpiServerOptions options, ScpiLanguage language);
  /// For start() only: Listening is private.
  ScpiServer(ScpiServerOptions options, ScpiLanguage language, Listening listening);
  ScpiServer(const ScpiServer&) = delete;
  ScpiServer& operator=(const ScpiServer&) = delete;
  /// Ends all connections and joins the thread.
  ~ScpiServer() = default;

  /// Returns the port. Any thread.
  [[nodiscard]] std::uint16_t port() const { return listening_.port; }
  /// Returns "address:port". Any thread.
  [[nodiscard]] std::string endpoint() const { return options_.address + ":" + std::to_string(listening_.port); }

 private:
  const ScpiServerOptions options_;
  const ScpiLanguage language_;
  const Listening listening_;
  std::jthread thread_;  // last: ends before the members that it uses
};

}  // namespace todbench
