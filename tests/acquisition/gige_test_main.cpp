// main() of test programs with emulated GigE cameras. The control port of GigE Vision is fixed, so two such programs on
// one host would drive each other's cameras: each one moves into a network namespace of its own where the system
// permits it, and shares the host's loopback otherwise (ctest then runs one at a time).
#include <gmock/gmock.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

#include "tests/acquisition/gige_test_support.h"

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
  if (!raise_loopback()) {
    std::fprintf(stderr, "The loopback of a private network cannot be raised: %s\n", std::strerror(errno));
    std::exit(EXIT_FAILURE);
  }
}

/// The other end of CameraProcess: '+' on stdout when the camera answers, then serves until it is killed.
int serve_camera(double frame_rate_hz) {
  todbench::EmulatedGigeCameraConfig config;
  config.frame_rate_hz = frame_rate_hz;
  const auto camera = todbench::EmulatedGigeCamera::start(config, todbench::testing_support::test_exposures(config));
  if (!camera) {
    std::fprintf(stderr, "%s\n", camera.error().message.c_str());
    return EXIT_FAILURE;
  }
  if (::write(STDOUT_FILENO, "+", 1) != 1) return EXIT_FAILURE;
  for (;;) ::pause();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--serve-camera") return serve_camera(std::atof(argv[2]));
  testing::InitGoogleMock(&argc, argv);
  enter_private_network();
  return RUN_ALL_TESTS();
}
