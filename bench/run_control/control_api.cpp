// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run_control/control_api.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "bench/plan/resources.h"
#include "bench/run_control/control_page.h"
#include "bench/session/manifest.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

using Segments = std::vector<std::string>;  ///< values of the parameters of a path

constexpr std::string_view json_type = "application/json";

ControlAnswer json_answer(const Json& json, int status = 200) {
  return {.status = status, .type = std::string(json_type), .body = to_line(json)};
}

ControlAnswer text_answer(std::string_view text, const char* type) {
  return {.status = 200, .type = type, .body = std::string(text)};
}

ControlAnswer no_such_run() {
  return control_error(404, "no such run");
}

/// Compares in a time that does not depend on the place of the first difference.
bool is_same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

/// Matches "/runs/{id}/files/{file}" with a path; {file} takes the rest, other parameters one part without slash.
std::optional<Segments> matched(std::string_view pattern, std::string_view path) {
  Segments values;
  while (!pattern.empty()) {
    if (pattern.front() != '{') {
      if (path.empty() || path.front() != pattern.front()) return std::nullopt;
      pattern.remove_prefix(1);
      path.remove_prefix(1);
      continue;
    }
    const bool rest = pattern == "{file}";
    const std::size_t end = rest ? path.size() : std::min(path.find('/'), path.size());
    if (end == 0) return std::nullopt;
    values.emplace_back(path.substr(0, end));
    path.remove_prefix(end);
    pattern.remove_prefix(pattern.find('}') + 1);
  }
  return path.empty() ? std::optional(values) : std::nullopt;
}

std::string type_of(const std::filesystem::path& file) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> types{{{".json", "application/json"},
                                                                                {".html", "text/html; charset=utf-8"},
                                                                                {".csv", "text/csv; charset=utf-8"},
                                                                                {".toml", "application/toml"},
                                                                                {".txt", "text/plain; charset=utf-8"},
                                                                                {".pdf", "application/pdf"},
                                                                                {".png", "image/png"},
                                                                                {".svg", "image/svg+xml"},
                                                                                {".xml", "application/xml"}}};
  const std::string ending = file.extension().string();
  const auto found = std::find_if(types.begin(), types.end(), [&](const auto& type) { return type.first == ending; });
  return std::string(found == types.end() ? std::string_view("application/octet-stream") : found->second);
}

}  // namespace

Json cameras_json(const CameraRegistry::Listing& listing) {
  Json cameras = Json::array();
  for (const auto& c : listing.cameras) {
    cameras.push_back({{"id", c.id},
                       {"vendor", c.vendor},
                       {"model", c.model},
                       {"serial", c.serial},
                       {"transport", c.transport},
                       {"address", c.address}});
  }
  return {{"cameras", cameras}, {"warnings", listing.warnings}};
}

ControlAnswer control_error(int status, std::string_view sentence) {
  return json_answer({{"error", sentence}}, status);
}

/// The functions behind the paths.
struct ControlHandlers {
  static ControlAnswer page(ControlApi&, const Segments&, const ControlRequest&) {
    return text_answer(control_html(), "text/html; charset=utf-8");
  }
  static ControlAnswer style(ControlApi&, const Segments&, const ControlRequest&) {
    return text_answer(control_css(), "text/css; charset=utf-8");
  }
  static ControlAnswer script(ControlApi&, const Segments&, const ControlRequest&) {
    return text_answer(control_js(), "text/javascript; charset=utf-8");
  }
  static ControlAnswer description(ControlApi&, const Segments&, const ControlRequest&) {
    return text_answer(openapi_json(), "application/json");
  }

  static ControlAnswer cameras(ControlApi& api, const Segments&, const ControlRequest&) {
    const std::lock_guard lock(api.listing_);
    CameraRegistry::Listing shown;
    // A search for devices would disturb the camera of a run.
    if (api.queue_.is_running()) {
      shown.warnings.emplace_back("a run uses the devices: these cameras were found before it");
    } else if (api.options_.list_cameras) {
      api.last_listing_ = api.options_.list_cameras();
    }
    const CameraRegistry::Listing& last = api.last_listing_;
    shown.cameras = last.cameras;
    shown.warnings.insert(shown.warnings.begin(), last.warnings.begin(), last.warnings.end());
    return json_answer(cameras_json(shown));
  }

  static ControlAnswer plans(ControlApi&, const Segments&, const ControlRequest&) {
    return json_answer({{"plans", resource_names(ResourceKind::plan)}});
  }

  static Result<RequestedRun> requested(ControlApi& api, const RunRequest& request) {
    return requested_run(request, api.queue_.sessions(), api.options_.programs);
  }

  static ControlAnswer check(ControlApi& api, const Segments&, const ControlRequest& request) {
    const auto asked = parse_run_request(request.body);
    if (!asked) return control_error(400, asked.error().message);
    const auto run = requested(api, *asked);
    if (!run) {
      const Error& error = run.error();
      return json_answer(
          {{"valid", false}, {"error", error.message}, {"key", error.key ? Json(error.key->name) : Json()}});
    }
    const Plan& plan = run->plan.plan();
    return json_answer({{"valid", true},
                        {"name", plan.name},
                        {"mode", to_string(run->mode)},
                        {"camera", plan.camera.id.empty() ? Json() : Json(plan.camera.id)},
                        {"seed", plan.seed}});
  }

  static ControlAnswer start(ControlApi& api, const Segments&, const ControlRequest& request) {
    const auto asked = parse_run_request(request.body);
    if (!asked) return control_error(400, asked.error().message);
    auto run = requested(api, *asked);
    if (!run) return control_error(422, run.error().message);
    const auto id = api.queue_.add(std::move(*run));
    if (!id) return control_error(503, id.error().message);
    const auto snapshot = api.queue_.snapshot(*id);
    ControlAnswer answer{.status = 201, .body = snapshot ? snapshot->json : to_line(Json{{"id", *id}})};
    answer.location = "/api/v1/runs/" + *id;
    return answer;
  }

  static ControlAnswer runs(ControlApi& api, const Segments&, const ControlRequest&) {
    return json_answer(api.queue_.list());
  }

  static ControlAnswer run(ControlApi& api, const Segments& path, const ControlRequest&) {
    const auto snapshot = api.queue_.snapshot(path[0]);
    return snapshot ? ControlAnswer{.body = snapshot->json} : no_such_run();
  }

  static ControlAnswer events(ControlApi& api, const Segments& path, const ControlRequest&) {
    if (!api.queue_.snapshot(path[0])) return no_such_run();
    ControlAnswer answer{.type = "text/event-stream"};
    answer.events_of = path[0];
    return answer;
  }

  static ControlAnswer reply(ControlApi& api, const Segments& path, const ControlRequest& request) {
    const Json json = Json::parse(request.body, nullptr, false);
    if (json.is_discarded()) return control_error(400, "the body is not valid JSON");
    const JsonReader reader(json);
    const std::string word = reader.at("answer").text();
    const JsonReader number_there = reader.at_if_there("number");
    const auto number = number_there.is_null() ? std::nullopt : std::optional(number_there.count());
    if (auto read = reader.finish(); !read) return control_error(400, read.error().message);
    if (word != "done" && word != "stop") return control_error(400, "'answer': expected 'done' or 'stop'");
    const auto answered =
        api.queue_.answer(path[0], number, word == "done" ? OperatorAnswer::done : OperatorAnswer::stop);
    if (answered) return json_answer({{"accepted", true}}, 202);
    return control_error(answered.error().code == ErrorCode::not_found ? 404 : 409, answered.error().message);
  }

  static ControlAnswer stop(ControlApi& api, const Segments& path, const ControlRequest&) {
    if (!api.queue_.stop(path[0])) return no_such_run();
    return json_answer({{"accepted", true}}, 202);
  }

  static ControlAnswer picture(ControlApi& api, const Segments& path, std::string LivePages::*part, const char* type) {
    if (!api.queue_.snapshot(path[0])) return no_such_run();
    const auto pages = api.queue_.pages(path[0]);
    if (!pages || ((*pages).*part).empty()) return control_error(404, "the run has no such picture yet");
    return text_answer((*pages).*part, type);
  }
  static ControlAnswer curve(ControlApi& api, const Segments& path, const ControlRequest&) {
    return picture(api, path, &LivePages::curve_svg, "image/svg+xml");
  }
  static ControlAnswer frame(ControlApi& api, const Segments& path, const ControlRequest&) {
    return picture(api, path, &LivePages::picture_png, "image/png");
  }

  /// Manifest of a session that has ended; the answer that refuses it otherwise.
  static tl::expected<std::pair<std::filesystem::path, Json>, ControlAnswer> manifest(ControlApi& api,
                                                                                      const std::string& id) {
    const auto folder = api.queue_.folder(id);
    if (!folder) return tl::unexpected(no_such_run());
    const auto text = folder->empty() ? fail(ErrorCode::io, "") : read_text_file(*folder / manifest_name);
    Json json = text ? Json::parse(*text, nullptr, false) : Json();
    if (!json.is_object() || !json.contains("files") || !json["files"].is_array())
      return tl::unexpected(control_error(409, "the session has no manifest: its run has not ended"));
    return std::pair(*folder, std::move(json));
  }

  static ControlAnswer files(ControlApi& api, const Segments& path, const ControlRequest&) {
    const auto session = manifest(api, path[0]);
    if (!session) return session.error();
    return json_answer({{"session", session->first.string()}, {"files", session->second["files"]}});
  }

  static ControlAnswer file(ControlApi& api, const Segments& path, const ControlRequest&) {
    const auto session = manifest(api, path[0]);
    if (!session) return session.error();
    const auto& [folder, json] = *session;
    const Json& files = json["files"];
    const bool listed = std::any_of(files.begin(), files.end(), [&](const Json& entry) {
      return entry.is_object() && entry.value("path", Json()) == Json(path[1]);
    });
    const bool known = path[1] == manifest_name || (listed && is_session_file(path[1]));
    std::error_code problem;
    if (!known || !std::filesystem::is_regular_file(folder / path[1], problem))
      return control_error(404, "the manifest of the session lists no such file");
    ControlAnswer answer{.type = type_of(path[1])};
    answer.file = folder / path[1];
    return answer;
  }
};

namespace {

using Handler = ControlAnswer (*)(ControlApi&, const Segments&, const ControlRequest&);
enum class Needs { no_token, token };

struct HandledRoute {
  ControlApi::Route route;
  Needs needs;
  Handler handler;
};

using H = ControlHandlers;
constexpr std::array table{
    HandledRoute{{"GET", "/"}, Needs::no_token, H::page},
    HandledRoute{{"GET", "/control.css"}, Needs::no_token, H::style},
    HandledRoute{{"GET", "/control.js"}, Needs::no_token, H::script},
    HandledRoute{{"GET", "/api/v1/openapi.json"}, Needs::no_token, H::description},
    HandledRoute{{"GET", "/api/v1/cameras"}, Needs::token, H::cameras},
    HandledRoute{{"GET", "/api/v1/plans"}, Needs::token, H::plans},
    HandledRoute{{"POST", "/api/v1/plans/check"}, Needs::token, H::check},
    HandledRoute{{"GET", "/api/v1/runs"}, Needs::token, H::runs},
    HandledRoute{{"POST", "/api/v1/runs"}, Needs::token, H::start},
    HandledRoute{{"GET", "/api/v1/runs/{id}"}, Needs::token, H::run},
    HandledRoute{{"GET", "/api/v1/runs/{id}/events"}, Needs::token, H::events},
    HandledRoute{{"POST", "/api/v1/runs/{id}/answer"}, Needs::token, H::reply},
    HandledRoute{{"POST", "/api/v1/runs/{id}/stop"}, Needs::token, H::stop},
    HandledRoute{{"GET", "/api/v1/runs/{id}/curve.svg"}, Needs::token, H::curve},
    HandledRoute{{"GET", "/api/v1/runs/{id}/picture.png"}, Needs::token, H::frame},
    HandledRoute{{"GET", "/api/v1/runs/{id}/files"}, Needs::token, H::files},
    HandledRoute{{"GET", "/api/v1/runs/{id}/files/{file}"}, Needs::token, H::file},
};

struct FoundRoute {
  const HandledRoute* row = nullptr;
  Segments values{};
  std::string allow{};  ///< methods of the path
};

FoundRoute found_route(const ControlRequest& request) {
  FoundRoute found;
  const std::string_view method = request.method == "HEAD" ? std::string_view("GET") : request.method;
  for (const HandledRoute& row : table) {
    const auto values = matched(row.route.path, request.path);
    if (!values) continue;
    found.allow += (found.allow.empty() ? "" : ", ") + std::string(row.route.method);
    if (row.route.method == method) {
      found.row = &row;
      found.values = *values;
    }
  }
  return found;
}

}  // namespace

std::vector<ControlApi::Route> ControlApi::routes() {
  std::vector<Route> out;
  for (const HandledRoute& row : table) out.push_back(row.route);
  return out;
}

std::optional<ControlAnswer> ControlApi::refusal(const ControlRequest& request) const {
  const FoundRoute found = found_route(request);
  const bool open = found.row != nullptr && found.row->needs == Needs::no_token;
  // Without the token, a path that exists and one that does not get the same answer.
  if (!open && !is_same_secret(request.token, options_.token))
    return control_error(401, "the token is missing or wrong: send the header Authorization: Bearer TOKEN");
  if (found.row != nullptr) return std::nullopt;
  if (found.allow.empty()) return control_error(404, "no such path: /api/v1/openapi.json describes the interface");
  ControlAnswer answer = control_error(405, "this path allows " + found.allow);
  answer.allow = found.allow;
  return answer;
}

ControlAnswer ControlApi::answer(const ControlRequest& request) {
  if (auto refused = refusal(request)) return *refused;
  const FoundRoute found = found_route(request);
  return found.row->handler(*this, found.values, request);
}

}  // namespace todbench
