// The network half of an emulated SCPI instrument: one message per line over TCP.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "acquisition/core/result.h"
#include "sim_devices/lab/instruments/scpi_session.h"
#include "tod/instruments/descriptor.h"

namespace todbench {

struct ScpiServerOptions {
  std::string address = "127.0.0.1";    ///< IPv4 address to listen on
  std::uint16_t port = 0;               ///< 0: the system chooses
  std::size_t longest_message = 512;    ///< characters; a longer line is skipped to its end and reported as -363
  std::size_t most_clients = 8;         ///< one more is closed at once
  std::size_t most_unread = 64 * 1024;  ///< characters of answers a client may leave unread before it is dropped
};

/// Serves one instrument from a thread of its own until destroyed. Commands run on that thread, one at a time, whatever
/// client they come from. Every byte received is untrusted: memory per client is bounded by the options.
class ScpiServer {
  struct Listening {
    Descriptor socket;
    std::uint16_t port;
  };

 public:
  /// `not_found` when the address cannot be listened on.
  [[nodiscard]] static Result<std::unique_ptr<ScpiServer>> start(ScpiServerOptions options, ScpiLanguage language);
  /// For start() only: nobody else can make a Listening.
  ScpiServer(ScpiServerOptions options, ScpiLanguage language, Listening listening);
  ScpiServer(const ScpiServer&) = delete;
  ScpiServer& operator=(const ScpiServer&) = delete;
  /// Ends all connections and joins the thread.
  ~ScpiServer() = default;

  /// Any thread.
  [[nodiscard]] std::uint16_t port() const { return listening_.port; }
  [[nodiscard]] std::string endpoint() const { return options_.address + ":" + std::to_string(listening_.port); }

 private:
  const ScpiServerOptions options_;
  const ScpiLanguage language_;
  const Listening listening_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace todbench
