// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP server of run control: the interface on a socket, with limits on requests and connections.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "acquisition/base/result.h"
#include "bench/run_control/control_api.h"
#include "bench/serve/serve_address.h"

namespace todbench {

/// Options of the server.
struct ControlServerOptions {
  ServeAddress address{};                      ///< address to listen on
  std::string token{};                         ///< empty: a random token of 128 bits
  std::filesystem::path sessions = ".";        ///< folder in which session folders are created
  PlanPrograms programs = PlanPrograms::none;  ///< programs that a plan may start
  std::function<CameraRegistry::Listing()> list_cameras{};
};

/// Returns the token in a file, without leading and trailing blanks. Creates the file, readable by its owner only, with
/// a random token if it is absent. Errors: `invalid_input` (fewer than 16 characters, blanks or control characters),
/// `io`.
[[nodiscard]] Result<std::string> kept_token(const std::filesystem::path& file);

/// Server on its own threads, with at most four requests and 16 streams of events at a time.
class ControlServer {
 public:
  static constexpr std::size_t longest_body = std::size_t{256} * 1024;
  static constexpr std::size_t longest_path = 512;

  /// Starts the server. Errors: `io` (cannot listen on the address).
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> start(const ControlServerOptions& options);
  /// Stops the current run and waits for the end of its session.
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// Returns "http://127.0.0.1:8765/".
  [[nodiscard]] const std::string& url() const { return url_; }
  /// Returns the token.
  [[nodiscard]] const std::string& token() const { return token_; }

 private:
  struct Serving;
  ControlServer();
  std::unique_ptr<Serving> serving_;
  std::string url_, token_;
};

}  // namespace todbench
