// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usbip_server.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <fstream>
#include <map>
#include <mutex>
#include <thread>

namespace todbench {
namespace {

constexpr std::size_t header_bytes = 48;
constexpr std::uint32_t command_submit = 1, command_unlink = 2, reply_submit = 3, reply_unlink = 4;
constexpr std::uint32_t device_id = 1U << 16U | 2U;
constexpr std::uint32_t most_bytes = 16U << 20U;
using Header = std::array<std::uint8_t, header_bytes>;

/// Numbers are big-endian on the wire; word k is bytes 4k ... 4k+3.
std::uint32_t word(const Header& header, std::size_t k) {
  return static_cast<std::uint32_t>(header[4 * k]) << 24U | static_cast<std::uint32_t>(header[4 * k + 1]) << 16U |
         static_cast<std::uint32_t>(header[4 * k + 2]) << 8U | header[4 * k + 3];
}
void set_word(Header& header, std::size_t k, std::uint32_t value) {
  for (unsigned i = 0; i < 4; ++i) header[4 * k + i] = static_cast<std::uint8_t>(value >> (24U - 8U * i));
}

/// One CMD_SUBMIT.
struct Transfer {
  std::uint32_t sequence = 0;
  bool in = false;
  std::uint8_t endpoint = 0;
  std::uint32_t length = 0;
  UsbSetup setup;
  UsbBytes data;
};

Transfer transfer_of(const Header& header) {
  Transfer t;
  t.sequence = word(header, 1);
  t.in = word(header, 3) == 1;
  t.endpoint = static_cast<std::uint8_t>(word(header, 4) & 0x0FU);
  t.length = word(header, 6);
  const std::uint8_t* setup = header.data() + 40;
  const auto pair = [&](int at) { return static_cast<std::uint16_t>(setup[at] | setup[at + 1] << 8); };
  t.setup = {.request_type = setup[0], .request = setup[1], .value = pair(2), .index = pair(4), .length = pair(6)};
  return t;
}

bool read_all(int socket, void* data, std::size_t size) {
  auto* out = static_cast<std::uint8_t*>(data);
  while (size > 0) {
    const auto got = ::recv(socket, out, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    out += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int socket, const void* data, std::size_t size) {
  const auto* in = static_cast<const std::uint8_t*>(data);
  while (size > 0) {
    const auto put = ::send(socket, in, size, MSG_NOSIGNAL);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    in += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

}  // namespace

struct UsbIpServer::State {
  /// Transfers of one endpoint, in order, on a thread of its own: a waiting IN transfer holds up nothing else.
  struct Endpoint {
    std::deque<Transfer> queue;
    std::optional<std::uint32_t> active;
    std::stop_source cancel;
    std::optional<std::uint32_t> unlink;  ///< the command that cancels the active transfer
    std::jthread worker;
  };

  std::shared_ptr<UsbDevice> device;
  int socket = -1;
  std::atomic<bool> connected{true};
  std::mutex sending;
  std::mutex mutex;  ///< guards the endpoints
  std::condition_variable_any changed;
  std::map<std::uint32_t, Endpoint> endpoints;  ///< by number, IN and OUT apart
  std::jthread reader;

  ~State() {
    ::shutdown(socket, SHUT_RDWR);
    reader = {};
    for (auto& [number, endpoint] : endpoints) {
      const std::lock_guard lock(mutex);
      endpoint.worker.request_stop();
      endpoint.cancel.request_stop();
    }
    for (auto& [number, endpoint] : endpoints) endpoint.worker = {};
    ::close(socket);
  }

  void read_commands();
  void submit(Transfer transfer);
  void unlink(std::uint32_t sequence, std::uint32_t victim);
  void work(std::uint32_t number, const std::stop_token& stop);
  /// The bytes of an IN transfer, the count of an OUT one, or nothing to stall or after cancelling.
  [[nodiscard]] std::optional<UsbBytes> perform(const Transfer& transfer, const std::stop_token& cancelled);
  void reply(const Transfer& transfer, const std::optional<UsbBytes>& answer);
  void reply_to_unlink(std::uint32_t sequence, int status);
};

std::optional<UsbBytes> UsbIpServer::State::perform(const Transfer& transfer, const std::stop_token& cancelled) {
  if (transfer.endpoint == 0) return usb_control(*device, transfer.setup, transfer.data);
  if (transfer.in) {
    return device->bulk_in(static_cast<std::uint8_t>(0x80U | transfer.endpoint), transfer.length, cancelled);
  }
  return device->bulk_out(transfer.endpoint, transfer.data) ? std::optional(UsbBytes()) : std::nullopt;
}

void UsbIpServer::State::reply(const Transfer& transfer, const std::optional<UsbBytes>& answer) {
  Header header{};
  set_word(header, 0, reply_submit);
  set_word(header, 1, transfer.sequence);
  const std::size_t sent = answer && transfer.in ? std::min<std::size_t>(answer->size(), transfer.length) : 0;
  const std::size_t done = answer && !transfer.in ? transfer.length : sent;
  set_word(header, 5, answer ? 0 : static_cast<std::uint32_t>(-EPIPE));
  set_word(header, 6, static_cast<std::uint32_t>(done));
  const std::lock_guard lock(sending);
  if (!write_all(socket, header.data(), header.size())) return;
  if (sent > 0) static_cast<void>(write_all(socket, answer->data(), sent));
}

void UsbIpServer::State::reply_to_unlink(std::uint32_t sequence, int status) {
  Header header{};
  set_word(header, 0, reply_unlink);
  set_word(header, 1, sequence);
  set_word(header, 5, static_cast<std::uint32_t>(status));
  const std::lock_guard lock(sending);
  static_cast<void>(write_all(socket, header.data(), header.size()));
}

void UsbIpServer::State::work(std::uint32_t number, const std::stop_token& stop) {
  for (;;) {
    Transfer transfer;
    std::stop_token cancelled;
    {
      std::unique_lock lock(mutex);
      Endpoint& endpoint = endpoints.at(number);
      if (!changed.wait(lock, stop, [&] { return !endpoint.queue.empty(); }) || stop.stop_requested()) return;
      transfer = std::move(endpoint.queue.front());
      endpoint.queue.pop_front();
      endpoint.active = transfer.sequence;
      endpoint.cancel = {};
      cancelled = endpoint.cancel.get_token();
    }
    const auto answer = perform(transfer, cancelled);
    std::optional<std::uint32_t> unlinked;
    {
      const std::lock_guard lock(mutex);
      Endpoint& endpoint = endpoints.at(number);
      endpoint.active.reset();
      unlinked = std::exchange(endpoint.unlink, std::nullopt);
    }
    const bool was_cancelled = !answer && cancelled.stop_requested();
    if (!was_cancelled) reply(transfer, answer);
    if (unlinked) reply_to_unlink(*unlinked, was_cancelled ? -ECONNRESET : 0);
  }
}

void UsbIpServer::State::submit(Transfer transfer) {
  const std::uint32_t number = transfer.endpoint | (transfer.in && transfer.endpoint != 0 ? 0x80U : 0U);
  {
    const std::lock_guard lock(mutex);
    const auto [entry, is_new] = endpoints.try_emplace(number);
    entry->second.queue.push_back(std::move(transfer));
    if (is_new) {
      entry->second.worker = std::jthread([this, number](const std::stop_token& stop) { work(number, stop); });
    }
  }
  changed.notify_all();
}

void UsbIpServer::State::unlink(std::uint32_t sequence, std::uint32_t victim) {
  {
    const std::lock_guard lock(mutex);
    for (auto& [number, endpoint] : endpoints) {
      if (endpoint.active == victim) {
        endpoint.unlink = sequence;
        endpoint.cancel.request_stop();
        return;  // its worker answers
      }
    }
    for (auto& [number, endpoint] : endpoints) {
      const auto waiting = std::find_if(endpoint.queue.begin(), endpoint.queue.end(),
                                        [&](const Transfer& t) { return t.sequence == victim; });
      if (waiting == endpoint.queue.end()) continue;
      endpoint.queue.erase(waiting);
      reply_to_unlink(sequence, -ECONNRESET);
      return;
    }
  }
  reply_to_unlink(sequence, 0);
}

void UsbIpServer::State::read_commands() {
  Header header{};
  while (read_all(socket, header.data(), header.size())) {
    if (word(header, 0) == command_unlink) {
      unlink(word(header, 1), word(header, 5));
      continue;
    }
    if (word(header, 0) != command_submit) break;
    Transfer transfer = transfer_of(header);
    if (transfer.length > most_bytes) break;
    if (!transfer.in) {
      transfer.data.resize(transfer.length);
      if (!read_all(socket, transfer.data.data(), transfer.data.size())) break;
    }
    submit(std::move(transfer));
  }
  connected = false;
  ::shutdown(socket, SHUT_RDWR);
}

UsbIpServer::UsbIpServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
UsbIpServer::~UsbIpServer() = default;

Result<std::unique_ptr<UsbIpServer>> UsbIpServer::serve(std::shared_ptr<UsbDevice> device, int socket) {
  int type = 0;
  socklen_t size = sizeof type;
  if (::getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_STREAM) {
    return fail(ErrorCode::invalid_input, "USB/IP needs a connected stream socket");
  }
  auto state = std::make_unique<State>();
  state->device = std::move(device);
  state->socket = socket;
  state->reader = std::jthread([raw = state.get()] { raw->read_commands(); });
  return std::unique_ptr<UsbIpServer>(new UsbIpServer(std::move(state)));
}

bool UsbIpServer::connected() const {
  return state_->connected;
}

Result<std::unique_ptr<UsbIpServer>> plug_into_kernel(std::shared_ptr<UsbDevice> device, int port) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return fail(ErrorCode::io, "no pair of sockets can be made");
  }
  const auto speed = static_cast<int>(device->descriptors().speed);
  auto server = UsbIpServer::serve(std::move(device), ends[0]);
  std::ofstream attach("/sys/devices/platform/vhci_hcd.0/attach");
  attach << port << ' ' << ends[1] << ' ' << device_id << ' ' << speed << std::flush;
  const bool attached = static_cast<bool>(attach);
  ::close(ends[1]);  // the kernel keeps its own reference
  if (!attached) {
    return fail(ErrorCode::not_found, "port " + std::to_string(port) +
                                          " of the virtual USB host controller cannot be used; is vhci-hcd loaded?");
  }
  return server;
}

}  // namespace todbench
