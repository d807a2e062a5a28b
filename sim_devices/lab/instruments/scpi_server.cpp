// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/instruments/scpi_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <list>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace todbench {
namespace {

struct Client {
  Client(Descriptor connected, const ScpiLanguage& language) : socket(std::move(connected)), session(language) {}
  Descriptor socket;
  ScpiSession session;
  std::string line, unsent;
  bool skipping = false;  // skips the rest of a line that was too long
  bool ended = false;     // the client sends no more; its answers are still delivered
  bool lost = false;
};

void end_line(Client& client) {
  if (!std::exchange(client.skipping, false)) {
    if (client.line.ends_with('\r')) client.line.pop_back();
    const std::string response = client.session.execute(client.line);
    if (!response.empty()) client.unsent += response + "\n";
  }
  client.line.clear();
}

void take(Client& client, std::string_view bytes, const ScpiServerOptions& options) {
  for (const char c : bytes) {
    if (client.unsent.size() > options.most_unread) {
      client.lost = true;
      return;
    }
    if (c == '\n') {
      end_line(client);
    } else if (!client.skipping) {
      client.line += c;
      if (client.line.size() <= options.longest_message) continue;
      client.session.report({-363, "Input buffer overrun"});
      client.skipping = true;
      client.line.clear();
    }
  }
}

bool would_block() {
  return errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK;
}

void receive(Client& client, const ScpiServerOptions& options) {
  std::array<char, 2048> chunk{};
  const ssize_t count = ::recv(client.socket.get(), chunk.data(), chunk.size(), 0);
  if (count > 0)
    take(client, {chunk.data(), static_cast<std::size_t>(count)}, options);
  else if (count == 0)
    client.ended = true;
  else if (!would_block())
    client.lost = true;
}

void deliver(Client& client) {
  while (!client.unsent.empty()) {
    const ssize_t sent = ::send(client.socket.get(), client.unsent.data(), client.unsent.size(), MSG_NOSIGNAL);
    if (sent < 0) {
      if (!would_block()) client.lost = true;
      return;
    }
    client.unsent.erase(0, static_cast<std::size_t>(sent));
  }
}

// Returns false if the system has no descriptor for the waiting connection.
bool accept_one(int listener, std::list<Client>& clients, const ScpiLanguage& language,
                const ScpiServerOptions& options) {
  Descriptor socket(::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.is_open()) return would_block() || errno == ECONNABORTED;
  const int on = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (clients.size() < options.most_clients) clients.emplace_back(std::move(socket), language);
  return true;
}

void serve(const std::stop_token& stop, int listener, const ScpiLanguage& language, const ScpiServerOptions& options) {
  constexpr int pause_ms = 200;  // after an accept that failed for lack of descriptors; the connection still waits
  const StopEvent stop_event(stop);
  std::list<Client> clients;
  bool accepting = true;
  while (!stop.stop_requested()) {
    std::vector<pollfd> polled{{stop_event.fd(), POLLIN, 0}, {accepting ? listener : -1, POLLIN, 0}};
    for (const auto& client : clients)
      // As long as answers are unread, no data are read from a client: TCP slows its sender.
      polled.push_back({client.socket.get(), static_cast<short>(client.unsent.empty() ? POLLIN : POLLOUT), 0});
    ::poll(polled.data(), polled.size(), accepting ? 500 : pause_ms);
    accepting = true;

    auto events = polled.begin() + 2;
    for (auto& client : clients) {
      const short happened = (events++)->revents;
      if (happened == 0) continue;
      if (client.unsent.empty()) receive(client, options);
      deliver(client);
    }
    clients.remove_if([](const Client& c) { return c.lost || (c.ended && c.unsent.empty()); });
    if (polled[1].revents != 0) accepting = accept_one(listener, clients, language, options);
  }
}

}  // namespace

Result<std::unique_ptr<ScpiServer>> ScpiServer::start(ScpiServerOptions options, ScpiLanguage language) {
  const auto failed = [&](const std::string& why) {
    return fail(ErrorCode::not_found,
                "listening on " + options.address + ":" + std::to_string(options.port) + ": " + why);
  };
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options.port);
  if (::inet_pton(AF_INET, options.address.c_str(), &address.sin_addr) != 1) return failed("not an IPv4 address");
  Descriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;  // a restarted laboratory gets its port back at once
  socklen_t size = sizeof address;
  if (!listener.is_open() || ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(listener.get(), 16) != 0 ||
      ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return failed(std::generic_category().message(errno));
  return std::make_unique<ScpiServer>(std::move(options), std::move(language),
                                      Listening{std::move(listener), ntohs(address.sin_port)});
}

ScpiServer::ScpiServer(ScpiServerOptions options, ScpiLanguage language, Listening listening)
    : options_(std::move(options)),
      language_(std::move(language)),
      listening_(std::move(listening)),
      thread_([this](const std::stop_token& stop) { serve(stop, listening_.socket.get(), language_, options_); }) {}

}  // namespace todbench
