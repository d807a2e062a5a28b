// main() of the tests of the window: an application without a screen unless QT_QPA_PLATFORM names one, and a network
// of its own where the system permits it, because the control port of GigE Vision is fixed.
#include <gmock/gmock.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "tests/bench/gui/watched_application.h"

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

void enter_private_network() {
  const auto user = getuid();
  const auto group = getgid();
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
    std::fprintf(stderr, "Sharing the host's loopback: %s\n", std::strerror(errno));
    return;
  }
  write_file("/proc/self/setgroups", "deny");
  write_file("/proc/self/uid_map", std::to_string(user) + " " + std::to_string(user) + " 1");
  write_file("/proc/self/gid_map", std::to_string(group) + " " + std::to_string(group) + " 1");
  if (raise_loopback()) return;
  std::fprintf(stderr, "The loopback of a private network cannot be raised: %s\n", std::strerror(errno));
  std::exit(EXIT_FAILURE);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  if (testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();
  enter_private_network();
  if (!qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  const todbench::testing::WatchedApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
