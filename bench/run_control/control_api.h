// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP interface of run control without sockets: from a request to a response. docs/reference/openapi.json describes
// the interface.
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

/// Returns the OpenAPI 3.0 description, which is compiled in.
[[nodiscard]] std::string_view openapi_json();

/// Returns {"cameras": [{"id", "vendor", ...}], "warnings": [...]}.
[[nodiscard]] Json cameras_json(const CameraRegistry::Listing& listing);

/// HTTP request.
struct ControlRequest {
  std::string method;  ///< "GET", "POST", "HEAD"
  std::string path;    ///< decoded, without the query
  std::string token;   ///< token of the header Authorization: Bearer, or of the query; empty: none
  std::string body{};
};

/// HTTP response.
struct ControlAnswer {
  int status = 200;
  std::string type = "application/json";
  std::string body{};
  std::string location{};                       ///< location of a new run
  std::string allow{};                          ///< methods of a path, with status 405
  std::optional<std::filesystem::path> file{};  ///< sent in place of `body`
  std::optional<std::string> events_of{};       ///< id of the run whose events follow
};

/// Options of the interface.
struct ControlOptions {
  std::string token;
  PlanPrograms programs = PlanPrograms::none;               ///< programs that a plan may start
  std::function<CameraRegistry::Listing()> list_cameras{};  ///< lists the cameras
};

/// Handler of requests. Every path except the page, its files and the description requires the token. Any thread.
class ControlApi {
 public:
  /// `queue` must outlive this object.
  ControlApi(RunQueue& queue, ControlOptions options) : queue_(queue), options_(std::move(options)) {}

  /// Returns the response to a request that is rejected before its body is read: 401, 404, 405. Empty: the request is
  /// accepted.
  [[nodiscard]] std::optional<ControlAnswer> refusal(const ControlRequest& request) const;
  /// Returns the response to a request.
  [[nodiscard]] ControlAnswer answer(const ControlRequest& request);

  /// Method and path of a request, as in the OpenAPI description with the names of its parameters. Used by the test of
  /// the description.
  struct Route {
    std::string_view method, path;
  };
  [[nodiscard]] static std::vector<Route> routes();

 private:
  friend struct ControlHandlers;
  RunQueue& queue_;
  ControlOptions options_;
  std::mutex listing_;  ///< one listing at a time, because a listing uses the network
  CameraRegistry::Listing last_listing_;
};

/// Returns a response with an error: {"error": SENTENCE}.
[[nodiscard]] ControlAnswer control_error(int status, std::string_view sentence);

}  // namespace todbench
