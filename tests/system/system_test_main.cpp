// main() of the system tests. Where the system permits it, the test and the programs it starts have a network and a
// table of mounts of their own: the control port of GigE Vision is fixed, and a small disk is a mount.
#include <gmock/gmock.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
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

void enter_private_space() {
  const auto user = getuid();
  const auto group = getgid();
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNET | CLONE_NEWNS) != 0) {
    std::fprintf(stderr, "Sharing network and mounts of the host: %s\n", std::strerror(errno));
    return;
  }
  write_file("/proc/self/setgroups", "deny");
  write_file("/proc/self/uid_map", std::to_string(user) + " " + std::to_string(user) + " 1");
  write_file("/proc/self/gid_map", std::to_string(group) + " " + std::to_string(group) + " 1");
  ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
  if (raise_loopback()) return;
  std::fprintf(stderr, "The loopback of a private network cannot be raised: %s\n", std::strerror(errno));
  std::exit(EXIT_FAILURE);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  enter_private_space();
  return RUN_ALL_TESTS();
}
