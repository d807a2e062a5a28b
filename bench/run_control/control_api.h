// SPDX-License-Identifier: GPL-3.0-or-later
// The HTTP interface of run control without sockets: from a request to an answer. docs/reference/openapi.json describes
// it.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/camera_registry.h"
#include "bench/run_control/run_queue.h"
#include "bench/text/json.h"

namespace todbench {

/// The OpenAPI 3.0 description, compiled in.
[[nodiscard]] std::string_view openapi_json();

/// Returns {"cameras": [{"id", "vendor", ...}], "warnings": [...]}.
[[nodiscard]] Json cameras_json(const CameraRegistry::Listing& listing);

struct ControlRequest {
  std::string method;  ///< "GET", "POST", "HEAD"
  std::string path;    ///< decoded, without the query
  std::string token;   ///< of the header Authorization: Bearer, or of the query; empty: none
  std::string body{};
};

struct ControlAnswer {
  int status = 200;
  std::string type = "application/json";
  std::string body{};
  std::string location{};                       ///< of a new run
  std::string allow{};                          ///< methods of a path, with status 405
  std::optional<std::filesystem::path> file{};  ///< sent in place of `body`
  std::optional<std::string> events_of{};       ///< id of the run whose events follow
};

struct ControlOptions {
  std::string token;
  PlanPrograms programs = PlanPrograms::none;
  std::function<CameraRegistry::Listing()> list_cameras{};
};

/// Answers requests. Every path but the page, its files and the description needs the token. Any thread.
class ControlApi {
 public:
  /// `queue` must outlive this object.
  ControlApi(RunQueue& queue, ControlOptions options) : queue_(queue), options_(std::move(options)) {}

  /// Returns the answer to a request that is refused before its body is read: 401, 404, 405.
  [[nodiscard]] std::optional<ControlAnswer> refusal(const ControlRequest& request) const;
  [[nodiscard]] ControlAnswer answer(const ControlRequest& request);

  /// Path of the description with the names of its parameters, and its method; for the test of the description.
  struct Route {
    std::string_view method, path;
  };
  [[nodiscard]] static std::vector<Route> routes();

 private:
  friend struct ControlHandlers;
  RunQueue& queue_;
  ControlOptions options_;
  std::mutex listing_;  ///< one listing at a time, because it uses the network
  CameraRegistry::Listing last_listing_;
};

/// Answer with an error: {"error": SENTENCE}.
[[nodiscard]] ControlAnswer control_error(int status, std::string_view sentence);

}  // namespace todbench
