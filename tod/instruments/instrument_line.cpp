// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/instrument_line.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

namespace todbench {
namespace {

using TimePoint = InstrumentLine::TimePoint;

constexpr std::string_view serial_scheme = "serial:", vxi11_scheme = "vxi11:";

std::string line_reason(int error) {
  return std::generic_category().message(error);
}

std::optional<std::uint16_t> port_from(std::string_view text) {
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, port);
  if (parsed.ec != std::errc{} || parsed.ptr != end || port == 0) return {};
  return port;
}

/// Host, and port if present.
std::optional<InstrumentAddress> host_and_port(std::string_view text, std::uint16_t port) {
  InstrumentAddress address;
  address.port = port;
  const auto colon = text.rfind(':');
  const auto bracket = text.rfind(']');
  if (colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket)) {
    const auto given = port_from(text.substr(colon + 1));
    if (!given) return {};
    address.port = *given;
    text = text.substr(0, colon);
  }
  const bool bracketed = text.size() > 2 && text.front() == '[' && text.back() == ']';
  if (bracketed) text = text.substr(1, text.size() - 2);
  const auto wrong = [](unsigned char c) { return c <= ' ' || c > '~' || c == '/'; };
  if (text.empty() || std::any_of(text.begin(), text.end(), wrong)) return {};
  address.host = text;
  return address;
}

Result<Descriptor> connect_one(const addrinfo& address, TimePoint deadline, const std::stop_token& stop) {
  Descriptor socket(::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.is_open()) return fail(ErrorCode::not_found, line_reason(errno));
  if (::connect(socket.get(), address.ai_addr, address.ai_addrlen) != 0) {
    if (errno != EINPROGRESS) return fail(ErrorCode::not_found, line_reason(errno));
    switch (wait_on(socket.get(), WaitFor::writing, deadline, stop)) {
      case Waited::stopped:
        return fail(ErrorCode::interrupted, "stopped on request");
      case Waited::timeout:
        return fail(ErrorCode::not_found, "no connection within the time limit");
      case Waited::ready:
        break;
    }
    int error = 0;
    socklen_t size = sizeof error;
    ::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) return fail(ErrorCode::not_found, line_reason(error));
  }
  const int on = 1;  // commands are a few bytes: never delay them to fill a packet
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return socket;
}

tl::unexpected<Error> not_ready(Waited waited) {
  if (waited == Waited::stopped) return fail(ErrorCode::interrupted, "stopped on request");
  return fail(ErrorCode::timeout, "no answer within the time limit");
}

}  // namespace

Result<InstrumentAddress> instrument_address(const std::string& text, std::uint16_t port) {
  std::string_view rest = text;
  if (rest.starts_with(serial_scheme)) {
    rest.remove_prefix(serial_scheme.size());
    const bool printable = std::all_of(rest.begin(), rest.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (!rest.starts_with('/') || !printable)
      return fail(ErrorCode::invalid_input, "'" + text + "' is not an address of the form serial:/dev/NAME");
    return InstrumentAddress{InstrumentAddress::Kind::serial, "", 0, std::string(rest)};
  }
  const bool vxi11 = rest.starts_with(vxi11_scheme);
  std::string device;
  if (vxi11) {
    rest.remove_prefix(vxi11_scheme.size());
    const auto slash = rest.find('/');
    device = slash == std::string_view::npos ? "inst0" : rest.substr(slash + 1);
    rest = rest.substr(0, slash);
    const bool printable = std::all_of(device.begin(), device.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (device.empty() || device.size() > 64 || !printable)
      return fail(ErrorCode::invalid_input, "'" + text + "' is not an address of the form vxi11:HOST[:PORT][/DEVICE]");
  }
  auto address = host_and_port(rest, vxi11 ? 0 : port);
  if (!address)
    return fail(ErrorCode::invalid_input,
                "'" + text + "' is not an address of the form " + (vxi11 ? "vxi11:HOST[:PORT][/DEVICE]" : "host:port"));
  if (vxi11) address->kind = InstrumentAddress::Kind::vxi11;
  address->device = device;
  return *address;
}

Result<Descriptor> connect_tcp(const std::string& host, std::uint16_t port, TimePoint deadline,
                               const std::stop_token& stop) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); error != 0)
    return fail(ErrorCode::not_found, ::gai_strerror(error));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, &::freeaddrinfo);
  Result<Descriptor> socket = fail(ErrorCode::not_found, "the name has no address");
  for (const addrinfo* address = addresses.get(); address != nullptr && !socket; address = address->ai_next) {
    socket = connect_one(*address, deadline, stop);
    if (!socket && socket.error().code == ErrorCode::interrupted) break;
  }
  return socket;
}

Result<void> send_all(int fd, std::string_view bytes, TimePoint deadline, const std::stop_token& stop) {
  while (!bytes.empty()) {
    ssize_t sent = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == ENOTSOCK) sent = ::write(fd, bytes.data(), bytes.size());
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return fail(ErrorCode::disconnected, line_reason(errno));
    if (const auto waited = wait_on(fd, WaitFor::writing, deadline, stop); waited != Waited::ready)
      return not_ready(waited);
  }
  return {};
}

Result<std::string> receive_some(int fd, TimePoint deadline, const std::stop_token& stop) {
  for (;;) {
    if (const auto waited = wait_on(fd, WaitFor::reading, deadline, stop); waited != Waited::ready)
      return not_ready(waited);
    std::array<char, 4096> chunk{};
    const ssize_t count = ::read(fd, chunk.data(), chunk.size());
    if (count == 0) return fail(ErrorCode::disconnected, "the instrument closed the connection");
    if (count > 0) return std::string(chunk.data(), static_cast<std::size_t>(count));
    if (errno != EINTR && errno != EAGAIN && errno != EWOULDBLOCK)
      return fail(ErrorCode::disconnected, line_reason(errno));
  }
}

}  // namespace todbench
