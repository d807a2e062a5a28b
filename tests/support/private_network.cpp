// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/private_network.h"

#include <fcntl.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

namespace todbench::testing_support {
namespace {

void write_file(const char* path, const std::string& text) {
  std::ofstream(path) << text;
}

bool raise_loopback() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  ifreq request{};
  std::strncpy(request.ifr_name, "lo", IFNAMSIZ - 1);
  request.ifr_flags = IFF_UP | IFF_RUNNING;
  const bool raised = ::ioctl(fd, SIOCSIFFLAGS, &request) == 0;
  ::close(fd);
  return raised;
}

sockaddr_in control_port_of_loopback() {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(3956);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// The control port of GigE Vision is fixed: of the programs that share a loopback one at a time may have it. Waits for
/// the others and keeps the lock until this process ends; says who is in the way.
void take_turns_at_the_control_port() {
  const int lock = ::open("/tmp/todbench_gige_tests.lock", O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock >= 0 && ::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    std::fputs("Another test program has the GigE Vision control port of this host (UDP 3956); waiting for it.\n",
               stderr);
    ::flock(lock, LOCK_EX);
  }
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = control_port_of_loopback();
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 && errno == EADDRINUSE) {
    std::fputs(
        "UDP port 3956 of 127.0.0.1 is in use by a program that is no test: emulated GigE cameras cannot start before "
        "it ends (ss -ulpn 'sport = 3956' shows it).\n",
        stderr);
  }
  ::close(fd);
}

enum class Mounts { shared, own };

void enter(Mounts mounts) {
  const auto user = getuid();
  const auto group = getgid();
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNET | (mounts == Mounts::own ? CLONE_NEWNS : 0)) != 0) {
    std::fprintf(stderr, "Sharing the host's loopback%s: %s\n", mounts == Mounts::own ? " and mounts" : "",
                 std::strerror(errno));
    take_turns_at_the_control_port();
    return;
  }
  write_file("/proc/self/setgroups", "deny");
  write_file("/proc/self/uid_map", std::to_string(user) + " " + std::to_string(user) + " 1");
  write_file("/proc/self/gid_map", std::to_string(group) + " " + std::to_string(group) + " 1");
  if (mounts == Mounts::own) ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
  if (!raise_loopback()) {
    std::fprintf(stderr, "The loopback of a private network cannot be raised: %s\n", std::strerror(errno));
    std::exit(EXIT_FAILURE);
  }
}

}  // namespace

void enter_private_network() {
  enter(Mounts::shared);
}

void enter_private_network_and_mounts() {
  enter(Mounts::own);
}

}  // namespace todbench::testing_support
