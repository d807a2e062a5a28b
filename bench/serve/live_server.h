// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP server for the live page: read only, protected by a token.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "acquisition/base/result.h"
#include "bench/serve/serve_address.h"

namespace todbench {

/// Current content of the page. Immutable after show().
struct LivePages {
  std::string state_json;
  std::string curve_svg;    ///< empty: not available yet
  std::string picture_png;  ///< empty: not available yet
};

/// Server on its own threads. New content replaces the old content, and show() does not wait for a connection. A slow
/// or stalled browser therefore does not delay the run.
class LiveServer {
 public:
  /// Starts the server. Errors: `io` (cannot listen on the address).
  [[nodiscard]] static Result<std::unique_ptr<LiveServer>> start(const ServeAddress& address);
  /// Waits at most four seconds for open connections. At most twenty are open.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// Returns "http://127.0.0.1:8080/TOKEN/", the only address to which the server responds. The token has 128 random
  /// bits.
  [[nodiscard]] const std::string& url() const { return url_; }
  /// Replaces the content. Any thread.
  void show(std::shared_ptr<const LivePages> pages);
  /// Waits until a client has requested the latest content, at most `patience`. Returns immediately if there was no
  /// request in the last five seconds.
  void wait_until_seen(std::chrono::milliseconds patience);

 private:
  struct Serving;
  LiveServer();

  std::unique_ptr<Serving> serving_;
  std::string url_;
};

}  // namespace todbench
