// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/gvsp_sockets.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include "acquisition/aravis/gvcp_client.h"

namespace todbench {
namespace {

/// Longest control message with its header. Longer ones are truncated, and rejected for their length.
constexpr std::size_t most_datagram_bytes = 1024;
/// Packets handed to the kernel in one call.
constexpr std::size_t batch = 64;
/// Space for several frames, so that sending waits for the reader and not for this program.
constexpr int send_buffer_bytes = 8 << 20;

sockaddr_in socket_address(std::uint32_t address, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = htonl(address);
  out.sin_port = htons(port);
  return out;
}

bool bind_to(int fd, std::uint32_t address, std::uint16_t port) {
  const sockaddr_in where = socket_address(address, port);
  return ::bind(fd, reinterpret_cast<const sockaddr*>(&where), sizeof where) == 0;
}

Descriptor udp_socket() {
  return Descriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
}

std::uint32_t host_order(const sockaddr* address) {
  sockaddr_in in{};
  std::memcpy(&in, address, sizeof in);
  return ntohl(in.sin_addr.s_addr);
}

/// Index of the interface on which a datagram arrived; 0 if the kernel does not report it.
int arrival_interface(msghdr& message) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != IPPROTO_IP || c->cmsg_type != IP_PKTINFO) continue;
    in_pktinfo info{};
    std::memcpy(&info, CMSG_DATA(c), sizeof info);
    return info.ipi_ifindex;
  }
  return 0;
}

struct Received {
  GvcpDatagram datagram;
  int interface = 0;
};

std::optional<Received> receive_from(int fd) {
  std::array<std::uint8_t, most_datagram_bytes> content;
  alignas(cmsghdr) std::array<char, 128> control;
  sockaddr_in from{};
  iovec part{content.data(), content.size()};
  msghdr message{};
  message.msg_name = &from;
  message.msg_namelen = sizeof from;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const auto bytes = ::recvmsg(fd, &message, MSG_DONTWAIT);
  if (bytes < 0) return std::nullopt;
  Received out;
  out.datagram.content.assign(content.begin(), content.begin() + bytes);
  out.datagram.from = {ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)};
  out.interface = arrival_interface(message);
  return out;
}

}  // namespace

std::optional<LocalInterface> find_interface(const std::string& ipv4) {
  in_addr wanted{};
  if (inet_pton(AF_INET, ipv4.c_str(), &wanted) != 1) return std::nullopt;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return std::nullopt;
  std::optional<LocalInterface> found;
  for (const ifaddrs* entry = list; entry != nullptr && !found; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET || (entry->ifa_flags & IFF_UP) == 0)
      continue;
    if (host_order(entry->ifa_addr) != ntohl(wanted.s_addr)) continue;
    found = LocalInterface{static_cast<int>(if_nametoindex(entry->ifa_name)), ntohl(wanted.s_addr),
                           entry->ifa_netmask != nullptr ? host_order(entry->ifa_netmask) : 0xFF000000};
  }
  freeifaddrs(list);
  return found;
}

Result<ControlSockets> ControlSockets::open(const LocalInterface& where) {
  ControlSockets out;
  out.interface_ = where.index;
  out.own_ = udp_socket();
  out.broadcast_ = udp_socket();
  out.wake_ = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (out.own_.get() < 0 || out.broadcast_.get() < 0 || out.wake_.get() < 0) {
    return fail(ErrorCode::not_found, std::string("the socket cannot be created: ") + std::strerror(errno));
  }
  if (!bind_to(out.own_.get(), where.address, gvcp_port)) {
    return fail(ErrorCode::not_found, std::string("UDP port 3956 is busy: ") + std::strerror(errno));
  }
  // Every camera of a host receives broadcasts. If that is impossible, the camera is found only by its address.
  const int on = 1;
  setsockopt(out.broadcast_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  setsockopt(out.broadcast_.get(), IPPROTO_IP, IP_PKTINFO, &on, sizeof on);
  if (!bind_to(out.broadcast_.get(), INADDR_BROADCAST, gvcp_port)) out.broadcast_ = Descriptor();
  return out;
}

std::optional<GvcpDatagram> ControlSockets::receive(std::chrono::milliseconds patience) {
  std::array<pollfd, 3> waiting{{{own_.get(), POLLIN, 0}, {wake_.get(), POLLIN, 0}, {broadcast_.get(), POLLIN, 0}}};
  if (::poll(waiting.data(), waiting.size(), static_cast<int>(patience.count())) <= 0) return std::nullopt;
  if ((waiting[1].revents & POLLIN) != 0) {
    eventfd_t count = 0;
    eventfd_read(wake_.get(), &count);
    return std::nullopt;
  }
  if ((waiting[0].revents & POLLIN) != 0) {
    if (auto received = receive_from(own_.get())) return std::move(received->datagram);
  }
  if ((waiting[2].revents & POLLIN) != 0) {
    auto received = receive_from(broadcast_.get());
    // The answer to a broadcast on another interface would contain an address from which the client cannot stream.
    if (received && received->interface == interface_) return std::move(received->datagram);
  }
  return std::nullopt;
}

void ControlSockets::send(std::span<const std::uint8_t> datagram, const GvcpEndpoint& to) {
  const sockaddr_in where = socket_address(to.address, to.port);
  // Errors are ignored, because a client may have stopped listening.
  static_cast<void>(::sendto(own_.get(), datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&where),
                             sizeof where));
}

void ControlSockets::wake() {
  eventfd_write(wake_.get(), 1);
}

Result<StreamSocket> StreamSocket::open(std::uint32_t address) {
  StreamSocket out;
  out.socket_ = udp_socket();
  if (out.socket_.get() < 0 || !bind_to(out.socket_.get(), address, 0)) {
    return fail(ErrorCode::not_found, std::string("the socket for frames cannot be created: ") + std::strerror(errno));
  }
  setsockopt(out.socket_.get(), SOL_SOCKET, SO_SNDBUF, &send_buffer_bytes, sizeof send_buffer_bytes);
  sockaddr_in bound{};
  socklen_t size = sizeof bound;
  getsockname(out.socket_.get(), reinterpret_cast<sockaddr*>(&bound), &size);
  out.port_ = ntohs(bound.sin_port);
  return out;
}

void StreamSocket::send(std::span<const GvspPacket> packets, const GvcpEndpoint& to, std::chrono::nanoseconds pause) {
  const auto begin = std::chrono::steady_clock::now();
  sockaddr_in where = socket_address(to.address, to.port);
  const std::size_t at_once = pause.count() > 0 ? 4 : batch;
  std::array<mmsghdr, batch> messages{};
  std::array<std::array<iovec, 2>, batch> parts{};
  for (std::size_t first = 0; first < packets.size(); first += at_once) {
    const std::size_t count = std::min(at_once, packets.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const GvspPacket& packet = packets[first + i];
      parts[i][0] = {const_cast<std::uint8_t*>(packet.head.data()), packet.head_bytes};
      parts[i][1] = {const_cast<std::uint8_t*>(packet.data.data()), packet.data.size()};
      messages[i].msg_hdr = {};
      messages[i].msg_hdr.msg_name = &where;
      messages[i].msg_hdr.msg_namelen = sizeof where;
      messages[i].msg_hdr.msg_iov = parts[i].data();
      messages[i].msg_hdr.msg_iovlen = packet.data.empty() ? 1 : 2;
    }
    for (std::size_t sent = 0; sent < count;) {
      const int done = ::sendmmsg(socket_.get(), messages.data() + sent, static_cast<unsigned>(count - sent), 0);
      // ECONNREFUSED refers to an earlier packet; this packet has not been sent.
      if (done <= 0 && errno != ECONNREFUSED && errno != EINTR) return;
      sent += done > 0 ? static_cast<std::size_t>(done) : 0;
    }
    if (pause.count() > 0) std::this_thread::sleep_until(begin + pause * static_cast<long>(first + count));
  }
}

}  // namespace todbench
