#include "tod/instruments/scpi_client.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <system_error>

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

struct Endpoint {
  std::string host, port;
};

std::optional<Endpoint> endpoint_from(const std::string& text) {
  Endpoint endpoint{text, "5025"};
  const auto colon = text.rfind(':');
  const auto bracket = text.rfind(']');
  const bool has_port = colon != std::string::npos && (bracket == std::string::npos || colon > bracket);
  if (has_port) endpoint = {text.substr(0, colon), text.substr(colon + 1)};
  if (endpoint.host.size() > 2 && endpoint.host.front() == '[' && endpoint.host.back() == ']')
    endpoint.host = endpoint.host.substr(1, endpoint.host.size() - 2);
  unsigned port = 0;
  const char* end = endpoint.port.data() + endpoint.port.size();
  const auto parsed = std::from_chars(endpoint.port.data(), end, port);
  if (endpoint.host.empty() || parsed.ec != std::errc{} || parsed.ptr != end || port < 1 || port > 65535) return {};
  return endpoint;
}

std::string reason(int error) {
  return std::generic_category().message(error);
}

std::string in_seconds(std::chrono::milliseconds time) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), static_cast<double>(time.count()) / 1000.0);
  return std::string(text.data(), end.ptr) + " s";
}

// Text of a peer in our messages: short, and nothing that moves the cursor of a terminal.
std::string printable(std::string_view text) {
  std::string shown(text.substr(0, 80));
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return "'" + shown + "'";
}

Result<Descriptor> connect_to(const addrinfo& address, Clock::time_point deadline, const std::stop_token& stop) {
  Descriptor socket(::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.is_open()) return fail(ErrorCode::not_found, reason(errno));
  if (::connect(socket.get(), address.ai_addr, address.ai_addrlen) != 0) {
    if (errno != EINPROGRESS) return fail(ErrorCode::not_found, reason(errno));
    switch (wait_on(socket.get(), WaitFor::writing, deadline, stop)) {
      case Waited::stopped:
        return fail(ErrorCode::interrupted, "stopped on request");
      case Waited::timeout:
        return fail(ErrorCode::not_found, "no connection in time");
      case Waited::ready:
        break;
    }
    int error = 0;
    socklen_t size = sizeof error;
    ::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) return fail(ErrorCode::not_found, reason(error));
  }
  const int on = 1;  // commands are a few bytes: never hold them back for a fuller packet
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return socket;
}

// The error code of a SYST:ERR? answer such as -222,"Data out of range"; none when the line is something else.
std::optional<int> error_report(std::string_view line) {
  if (!line.empty() && line.front() == '+') line.remove_prefix(1);
  int code = 0;
  const auto parsed = std::from_chars(line.data(), line.data() + line.size(), code);
  const std::string_view rest(parsed.ptr, static_cast<std::size_t>(line.data() + line.size() - parsed.ptr));
  if (parsed.ec != std::errc{} || rest.size() < 3 || !rest.starts_with(",\"") || rest.back() != '"') return {};
  return code;
}

std::optional<double> number_from(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace

std::string to_text(const ScpiIdentity& identity) {
  return identity.vendor + " " + identity.model + ", serial " + identity.serial;
}

std::vector<std::string> scpi_fields(std::string_view answer) {
  std::vector<std::string> fields(1);
  char quote = 0;
  bool closed_just_now = false;  // a second quote directly after the first stands for one quote
  for (const char c : answer) {
    if (quote != 0 && c == quote) {
      quote = 0;
      closed_just_now = true;
      continue;
    }
    if (quote == 0 && (c == '"' || c == '\'')) {
      if (closed_just_now) fields.back() += c;
      quote = c;
    } else if (quote == 0 && c == ',') {
      fields.emplace_back();
    } else if (quote != 0 || c != ' ' || !fields.back().empty()) {
      fields.back() += c;
    }
    closed_just_now = false;
  }
  return fields;
}

std::string scpi_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

Result<ScpiClient> ScpiClient::connect(const std::string& endpoint, const ScpiClientOptions& options,
                                       const std::stop_token& stop) {
  const auto place = endpoint_from(endpoint);
  if (!place) return fail(ErrorCode::invalid_input, "'" + endpoint + "' is not host:port");
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(place->host.c_str(), place->port.c_str(), &hints, &found); error != 0)
    return fail(ErrorCode::not_found, "connecting to " + endpoint + ": " + ::gai_strerror(error));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, &::freeaddrinfo);

  const auto deadline = Clock::now() + options.connect_timeout;
  Result<Descriptor> socket = fail(ErrorCode::not_found, "no address");
  for (const addrinfo* address = addresses.get(); address != nullptr && !socket; address = address->ai_next) {
    socket = connect_to(*address, deadline, stop);
    if (!socket && socket.error().code == ErrorCode::interrupted) break;
  }
  if (!socket) return fail("connecting to " + endpoint, socket.error());

  ScpiClient client(std::move(*socket), options);
  if (auto identified = client.identify(stop); !identified) {
    Error error = identified.error();
    if (error.code != ErrorCode::interrupted) error.code = ErrorCode::not_found;
    return fail("identifying the instrument at " + endpoint, error);
  }
  return client;
}

Result<void> ScpiClient::identify(const std::stop_token& stop) {
  const auto deadline = Clock::now() + options_.answer_timeout;
  // Errors that others left in the queue are not ours.
  if (auto sent = send("*CLS\n*IDN?\n", deadline, stop); !sent) return tl::unexpected(sent.error());
  auto line = receive_line(deadline, stop);
  if (!line) return fail("*IDN?", line.error());
  auto fields = scpi_fields(*line);
  if (fields.size() != 4 || fields[1].empty() || fields[2].empty())
    return give_up(ErrorCode::not_found, "*IDN? answered " + printable(*line) + ", not vendor,model,serial,firmware");
  identity_ = {fields[0], fields[1], fields[2], fields[3]};
  return {};
}

Result<void> ScpiClient::command(std::string_view text, const std::stop_token& stop) {
  const auto deadline = Clock::now() + options_.answer_timeout;
  // Two lines in one packet: after a syntax error the rest of the same line would be thrown away with it (IEEE 488.2).
  if (auto sent = send(std::string(text) + "\nSYST:ERR?\n", deadline, stop); !sent) return sent;
  auto report = receive_line(deadline, stop);
  if (!report) return fail(text, report.error());
  const auto code = error_report(*report);
  if (!code) return give_up(ErrorCode::disconnected, std::string(text) + ": SYST:ERR? answered " + printable(*report));
  if (*code != 0)
    return fail(ErrorCode::invalid_input, std::string(text) + ": the instrument refuses: " + printable(*report));
  return {};
}

Result<std::string> ScpiClient::query(std::string_view text, const std::stop_token& stop) {
  const auto deadline = Clock::now() + options_.answer_timeout;
  if (auto sent = send(std::string(text) + "\nSYST:ERR?\n", deadline, stop); !sent) return tl::unexpected(sent.error());
  auto answer = receive_line(deadline, stop);
  if (!answer) return fail(text, answer.error());
  // A refused query has no answer of its own: the first line is the error report already.
  if (error_report(*answer))
    return fail(ErrorCode::invalid_input, std::string(text) + ": the instrument refuses: " + printable(*answer));
  auto report = receive_line(deadline, stop);
  if (!report) return fail(text, report.error());
  const auto code = error_report(*report);
  if (!code) return give_up(ErrorCode::disconnected, std::string(text) + ": SYST:ERR? answered " + printable(*report));
  if (*code != 0)
    return fail(ErrorCode::invalid_input, std::string(text) + ": the instrument refuses: " + printable(*report));
  return answer;
}

Result<std::vector<double>> ScpiClient::query_numbers(std::string_view text, std::size_t count,
                                                      const std::stop_token& stop) {
  auto answer = query(text, stop);
  if (!answer) return tl::unexpected(answer.error());
  std::vector<double> numbers;
  for (const auto& field : scpi_fields(*answer))
    if (const auto number = number_from(field)) numbers.push_back(*number);
  if (numbers.size() != count || scpi_fields(*answer).size() != count)
    return give_up(ErrorCode::disconnected, std::string(text) + ": answered " + printable(*answer) + ", expected " +
                                                std::to_string(count) + " number(s)");
  return numbers;
}

Result<void> ScpiClient::send(std::string_view text, Clock::time_point deadline, const std::stop_token& stop) {
  if (!socket_.is_open()) return fail(ErrorCode::disconnected, "the connection is closed");
  received_.clear();  // whatever came unasked belongs to nothing we will send
  while (!text.empty()) {
    const ssize_t sent = ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      text.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return give_up(ErrorCode::disconnected, reason(errno));
    switch (wait_on(socket_.get(), WaitFor::writing, deadline, stop)) {
      case Waited::stopped:
        return give_up(ErrorCode::interrupted, "stopped on request");
      case Waited::timeout:
        return give_up(ErrorCode::timeout, "takes no command within " + in_seconds(options_.answer_timeout));
      case Waited::ready:
        break;
    }
  }
  return {};
}

Result<std::string> ScpiClient::receive_line(Clock::time_point deadline, const std::stop_token& stop) {
  for (;;) {
    if (const auto end = received_.find('\n'); end != std::string::npos) {
      std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      return line;
    }
    if (received_.size() > options_.longest_answer)
      return give_up(ErrorCode::disconnected, "dropped: more than " + std::to_string(options_.longest_answer) +
                                                  " characters without a line end");
    const Waited waited = wait_on(socket_.get(), WaitFor::reading, deadline, stop);
    if (waited == Waited::stopped) return give_up(ErrorCode::interrupted, "stopped on request");
    if (waited == Waited::timeout)
      return give_up(ErrorCode::timeout, "no answer within " + in_seconds(options_.answer_timeout));
    std::array<char, 1024> chunk{};
    const ssize_t count = ::recv(socket_.get(), chunk.data(), chunk.size(), 0);
    if (count == 0) return give_up(ErrorCode::disconnected, "the instrument closed the connection");
    if (count > 0)
      received_.append(chunk.data(), static_cast<std::size_t>(count));
    else if (errno != EINTR && errno != EAGAIN && errno != EWOULDBLOCK)
      return give_up(ErrorCode::disconnected, reason(errno));
  }
}

tl::unexpected<Error> ScpiClient::give_up(ErrorCode code, std::string message) {
  socket_.close();
  received_.clear();
  return fail(code, std::move(message));
}

}  // namespace todbench
