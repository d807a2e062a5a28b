// An HTTP server for the live page: read only, behind a token.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "acquisition/core/result.h"
#include "bench/serve/serve_address.h"

namespace todbench {

/// What the page shows now. Immutable once handed over.
struct LivePages {
  std::string state_json;
  std::string curve_svg;    ///< empty: there is none yet
  std::string picture_png;  ///< empty: there is none yet
};

/// Serves on threads of its own. What is handed over replaces what was there, so that a browser that reads slowly, or
/// no more, delays nobody: show() waits for no connection.
class LiveServer {
 public:
  /// Errors: `io` when the address cannot be listened on.
  [[nodiscard]] static Result<std::unique_ptr<LiveServer>> start(const ServeAddress& address);
  /// Waits for connections that are open, two seconds each at most.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// "http://127.0.0.1:8080/TOKEN/": the only address with an answer. The token has 128 random bits.
  [[nodiscard]] const std::string& url() const { return url_; }
  /// Any thread.
  void show(std::shared_ptr<const LivePages> pages);
  /// Returns when somebody has asked for what was handed over last, at once when nobody has asked for anything in the
  /// last five seconds, and after `patience` at the latest.
  void wait_until_seen(std::chrono::milliseconds patience);

 private:
  struct Serving;
  LiveServer();

  std::unique_ptr<Serving> serving_;
  std::string url_;
};

}  // namespace todbench
