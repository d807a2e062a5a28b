// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run_control/control_server.h"

#include <fcntl.h>
#include <httplib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/try.h"
#include "bench/run_control/event_streams.h"
#include "bench/serve/guarded_server.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::size_t shortest_token = 16;
constexpr std::string_view bearer = "Bearer ";
/// A client of a large file must take at least this much in the mean.
constexpr std::size_t least_bytes_per_ms = 256;

ControlRequest request_of(const httplib::Request& from) {
  ControlRequest request{from.method, from.path, "", from.body};
  const std::string header = from.get_header_value("Authorization");
  request.token = header.starts_with(bearer) ? header.substr(bearer.size()) : from.get_param_value("token");
  return request;
}

/// Returns the answer to a request whose form is not served; httplib would buffer or unpack such bodies without bound.
std::optional<ControlAnswer> refused_form(const httplib::Request& request) {
  if (request.path.size() > ControlServer::longest_path) return control_error(414, "the path is too long");
  if (request.has_header("Range")) return control_error(400, "parts of files are not served: omit the header Range");
  if (request.method != "POST") return std::nullopt;
  if (request.has_header("Transfer-Encoding") || !request.has_header("Content-Length"))
    return control_error(411, "expected the header Content-Length and a body in one piece");
  const auto length = parse_number(request.get_header_value("Content-Length"));
  if (!length || *length < 0) return control_error(400, "the header Content-Length is not a number");
  if (*length > static_cast<double>(ControlServer::longest_body))
    return control_error(413, "the body has more than 256 KiB");
  if (request.has_header("Content-Encoding"))
    return control_error(415, "packed bodies are not read: omit the header Content-Encoding");
  const std::string type = request.get_header_value("Content-Type");
  if (*length > 0 && type.substr(0, type.find(';')) != "application/json")
    return control_error(415, "expected a body of type application/json");
  return std::nullopt;
}

void send_file(httplib::Response& response, const ControlAnswer& answer) {
  const auto stream = std::make_shared<std::ifstream>(*answer.file, std::ios::binary | std::ios::ate);
  const auto bytes = stream->tellg();
  if (!*stream || bytes < 0) {
    response.status = 404;
    response.set_content(control_error(404, "the file cannot be read").body, "application/json");
    return;
  }
  const auto size = static_cast<std::size_t>(bytes);
  if (size == 0) {
    response.set_content("", answer.type);
    return;
  }
  GuardedServer::allow_more_time(std::chrono::milliseconds(size / least_bytes_per_ms));
  response.set_content_provider(size, answer.type,
                                [stream](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                  std::array<char, 65536> piece{};
                                  const std::size_t wanted = std::min(length, piece.size());
                                  stream->seekg(static_cast<std::streamoff>(offset));
                                  if (!stream->read(piece.data(), static_cast<std::streamsize>(wanted))) return false;
                                  return sink.write(piece.data(), wanted);
                                });
}

}  // namespace

struct ControlServer::Serving {
  Serving(const ControlServerOptions& options, const std::string& token)
      : streams([this](const std::string& id) { return queue.snapshot(id); }),
        queue(options.sessions, [this] { streams.wake(); }),
        api(queue, {token, options.programs, options.list_cameras}) {
    server.set_payload_max_length(longest_body);
    server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      using Handled = httplib::Server::HandlerResponse;
      auto refused = api.refusal(request_of(request));
      if (!refused) refused = refused_form(request);
      if (refused) {
        send(response, *refused);
        return Handled::Handled;
      }
      if (request.method == "POST") return Handled::Unhandled;
      send(response, api.answer(request_of(request)));
      return Handled::Handled;
    });
    server.Post("[^]*", [this](const httplib::Request& request, httplib::Response& response) {
      send(response, api.answer(request_of(request)));
    });
  }

  void send(httplib::Response& response, const ControlAnswer& answer) {
    if (answer.file) {
      guard_report(response);
    } else {
      guard(response);
    }
    response.status = answer.status;
    if (!answer.location.empty()) response.set_header("Location", answer.location);
    if (!answer.allow.empty()) response.set_header("Allow", answer.allow);
    if (answer.status == 401) response.set_header("WWW-Authenticate", "Bearer");
    if (answer.events_of) {
      send_events(response, *answer.events_of);
    } else if (answer.file) {
      send_file(response, answer);
    } else {
      response.set_content(answer.body, answer.type);
    }
  }

  void send_events(httplib::Response& response, const std::string& id) {
    if (!streams.has_room()) {
      response.status = 503;
      response.set_content(control_error(503, "too many streams of events are open").body, "application/json");
      return;
    }
    response.set_content_provider("text/event-stream", [](std::size_t, httplib::DataSink& sink) {
      sink.done();
      return true;
    });
    GuardedServer::hand_over([this, id](int socket) { streams.add(socket, id); });
  }

  GuardedServer server;
  EventStreams streams;
  RunQueue queue;
  ControlApi api;
};

Result<std::string> kept_token(const std::filesystem::path& file) {
  if (!is_there(file)) {
    const std::string token = random_token();
    const Descriptor created(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
    const std::string line = token + "\n";
    if (!created.is_open() || ::write(created.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
      return fail(ErrorCode::io, file.string() + ": cannot be written: " + std::generic_category().message(errno));
    return token;
  }
  TODBENCH_TRY(const std::string text, read_text_file(file));
  const auto first = text.find_first_not_of(" \t\r\n");
  const std::string token =
      first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
  const bool plain = std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c <= '~'; });
  if (token.size() < shortest_token || !plain) {
    return fail(ErrorCode::invalid_input,
                file.string() + ": expected a token of at least 16 printable characters without blanks");
  }
  return token;
}

ControlServer::ControlServer() = default;

Result<std::unique_ptr<ControlServer>> ControlServer::start(const ControlServerOptions& options) {
  std::unique_ptr<ControlServer> out(new ControlServer);  // NOLINT: the constructor is private
  out->token_ = options.token.empty() ? random_token() : options.token;
  out->serving_ = std::make_unique<Serving>(options, out->token_);
  Serving& serving = *out->serving_;
  TODBENCH_TRY(const auto port, bind_to(serving.server, options.address));
  out->url_ = url_of(options.address, port);
  serving.server.start_listening();
  return out;
}

ControlServer::~ControlServer() {
  serving_->server.stop_listening();
  serving_->streams.shut_down();
}

}  // namespace todbench
