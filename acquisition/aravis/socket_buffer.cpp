// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/socket_buffer.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <charconv>
#include <climits>
#include <filesystem>
#include <string>
#include <system_error>

namespace todbench {
namespace {

bool is_udp_socket_on(int fd, std::uint16_t local_port) {
  int type = 0;
  socklen_t type_size = sizeof type;
  sockaddr_in local{};
  socklen_t local_size = sizeof local;
  return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) == 0 && type == SOCK_DGRAM &&
         getsockname(fd, reinterpret_cast<sockaddr*>(&local), &local_size) == 0 && local.sin_family == AF_INET &&
         ntohs(local.sin_port) == local_port;
}

std::optional<int> udp_socket_on(std::uint16_t local_port) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const std::string name = entry.path().filename().string();
    int fd = -1;
    std::from_chars(name.data(), name.data() + name.size(), fd);
    if (fd >= 0 && is_udp_socket_on(fd, local_port)) return fd;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::uint64_t> request_socket_buffer(std::uint16_t local_port, std::uint64_t bytes) {
  const auto fd = udp_socket_on(local_port);
  if (!fd) return std::nullopt;
  const int asked = static_cast<int>(std::min<std::uint64_t>(bytes, INT_MAX / 2));
  int granted = 0;
  socklen_t size = sizeof granted;
  if (setsockopt(*fd, SOL_SOCKET, SO_RCVBUF, &asked, sizeof asked) != 0) return std::nullopt;
  if (getsockopt(*fd, SOL_SOCKET, SO_RCVBUF, &granted, &size) != 0) return std::nullopt;
  // The kernel doubles the request for its own overhead and reports the doubled value (man 7 socket).
  return static_cast<std::uint64_t>(granted) / 2;
}

}  // namespace todbench
