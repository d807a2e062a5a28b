// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tod/instruments/scpi_lines.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "tod/instruments/instrument_line.h"
#include "tod/instruments/onc_rpc.h"
#include "tod/instruments/vxi11_line.h"

namespace todbench {
namespace {

constexpr std::size_t longest_serial_line = 512;
/// Time limit for sending to a client that does not read.
constexpr std::chrono::seconds lines_patience{5};

InstrumentLine::TimePoint soon() {
  return std::chrono::steady_clock::now() + lines_patience;
}

void serve_serial(const std::stop_token& stop, int fd, const ScpiLanguage& language, const std::string& ending) {
  ScpiSession session(language);
  std::string line;
  while (wait_on(fd, WaitFor::reading, std::nullopt, stop) == Waited::ready) {
    const auto some = receive_some(fd, soon(), stop);
    if (!some) return;
    for (const char c : *some) {
      line += c;
      if (line.size() > longest_serial_line) line.clear();
      if (!line.ends_with(ending)) continue;
      const std::string response = session.execute(line.substr(0, line.size() - ending.size()));
      line.clear();
      if (response.empty()) continue;
      if (!send_all(fd, response + ending, soon(), stop)) return;
    }
  }
}

/// One link of one client.
class Vxi11Session {
 public:
  Vxi11Session(const ScpiLanguage& language, std::uint16_t port) : session_(language), port_(port) {}

  /// The answer to a call, as a whole message.
  std::optional<std::string> answer(std::string_view call) {
    XdrReader reader(call);
    const auto id = reader.number(), direction = reader.number(), rpc = reader.number();
    const auto program = reader.number(), version = reader.number(), procedure = reader.number();
    for (int i = 0; i < 2; ++i) {  // credentials, verifier
      (void)reader.number();
      (void)reader.bytes();
    }
    if (!id || direction != 0U || rpc != 2U || !version || !procedure) return {};
    XdrWriter message;
    for (const std::uint32_t value : {*id, 1U, 0U, 0U, 0U}) message.number(value);
    XdrWriter results;
    const bool known = program == vxi11::core ? core(*procedure, reader, results)
                                              : program == vxi11::port_mapper && map(*procedure, results);
    message.number(known ? 0 : 3);  // or PROC_UNAVAIL
    return message.data() + results.data();
  }

 private:
  bool map(std::uint32_t procedure, XdrWriter& results) const {
    results.number(port_);
    return procedure == vxi11::get_port;
  }

  bool core(std::uint32_t procedure, XdrReader& arguments, XdrWriter& results) {
    switch (procedure) {
      case vxi11::create_link:
        create(arguments, results);
        return true;
      case vxi11::device_write:
        write(arguments, results);
        return true;
      case vxi11::device_read:
        read(arguments, results);
        return true;
      case vxi11::destroy_link:
        results.number(0);
        return true;
      default:
        return false;
    }
  }

  void create(XdrReader& arguments, XdrWriter& results) {
    for (int i = 0; i < 3; ++i) (void)arguments.number();
    const bool known = arguments.bytes() == "inst0";
    // A small receive size, so that clients have to divide what they write.
    for (const std::uint32_t value : {known ? 0U : 3U, 1U, 0U, 16U}) results.number(value);
  }

  void write(XdrReader& arguments, XdrWriter& results) {
    for (int i = 0; i < 3; ++i) (void)arguments.number();
    const auto flags = arguments.number();
    const auto data = arguments.bytes();
    heard_ += data.value_or("");
    if (flags.value_or(0) & vxi11::end_flag) {
      if (heard_.ends_with('\n')) heard_.pop_back();
      // A message that arrives before the last answer was read interrupts it (IEEE 488.2, 6.3.2.3).
      if (!unread_.empty()) session_.report({-410, "Query INTERRUPTED"});
      unread_ = session_.execute(heard_);
      heard_.clear();
    }
    results.number(0);
    results.number(static_cast<std::uint32_t>(data.value_or("").size()));
  }

  void read(XdrReader& arguments, XdrWriter& results) {
    (void)arguments.number();
    const std::size_t most = arguments.number().value_or(0);
    const std::string part = unread_.substr(0, most);
    unread_.erase(0, part.size());
    results.number(part.empty() ? vxi11::error_timeout : 0);
    results.number(unread_.empty() ? vxi11::end_reason : 1);
    results.bytes(part);
  }

  ScpiSession session_;
  std::uint16_t port_;
  std::string heard_, unread_;
};

void serve_vxi11_client(const std::stop_token& stop, int fd, Vxi11Session& session) {
  std::string received;
  for (;;) {
    auto record = take_rpc_record(received);
    if (!record) return;
    if (*record) {
      const auto answer = session.answer(**record);
      if (!answer || !send_all(fd, rpc_record(*answer), soon(), stop)) return;
      continue;
    }
    if (wait_on(fd, WaitFor::reading, std::nullopt, stop) != Waited::ready) return;
    const auto some = receive_some(fd, soon(), stop);
    if (!some) return;
    received += *some;
  }
}

void serve_vxi11(const std::stop_token& stop, int listener, std::uint16_t port, const ScpiLanguage& language) {
  while (wait_on(listener, WaitFor::reading, std::nullopt, stop) == Waited::ready) {
    const Descriptor socket(::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.is_open()) continue;
    Vxi11Session session(language, port);
    serve_vxi11_client(stop, socket.get(), session);
  }
}

tl::unexpected<Error> system_refuses(const std::string& what) {
  return fail(ErrorCode::not_found, what + ": " + std::generic_category().message(errno));
}

}  // namespace

Result<std::unique_ptr<ScpiSerialPort>> ScpiSerialPort::start(ScpiLanguage language, std::string ending) {
  Ends ends;
  ends.ours = Descriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 128> path{};
  if (!ends.ours.is_open() || ::grantpt(ends.ours.get()) != 0 || ::unlockpt(ends.ours.get()) != 0 ||
      ::ptsname_r(ends.ours.get(), path.data(), path.size()) != 0)
    return system_refuses("making a pseudo-terminal");
  ends.path = path.data();
  ends.theirs = Descriptor(::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios raw{};
  if (!ends.theirs.is_open() || ::tcgetattr(ends.theirs.get(), &raw) != 0) return system_refuses(ends.path);
  ::cfmakeraw(&raw);
  if (::tcsetattr(ends.theirs.get(), TCSANOW, &raw) != 0) return system_refuses(ends.path);
  return std::make_unique<ScpiSerialPort>(std::move(language), std::move(ending), std::move(ends));
}

ScpiSerialPort::ScpiSerialPort(ScpiLanguage language, std::string ending, Ends ends)
    : language_(std::move(language)),
      ending_(std::move(ending)),
      ends_(std::move(ends)),
      thread_([this](const std::stop_token& stop) { serve_serial(stop, ends_.ours.get(), language_, ending_); }) {}

Result<std::unique_ptr<ScpiVxi11Server>> ScpiVxi11Server::start(ScpiLanguage language) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Descriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  socklen_t size = sizeof address;
  if (!listener.is_open() || ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(listener.get(), 16) != 0 ||
      ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return system_refuses("listening on 127.0.0.1");
  return std::make_unique<ScpiVxi11Server>(std::move(language),
                                           Listening{std::move(listener), ntohs(address.sin_port)});
}

ScpiVxi11Server::ScpiVxi11Server(ScpiLanguage language, Listening listening)
    : language_(std::move(language)), listening_(std::move(listening)), thread_([this](const std::stop_token& stop) {
        serve_vxi11(stop, listening_.socket.get(), listening_.port, language_);
      }) {}

}  // namespace todbench
