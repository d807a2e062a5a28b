// SPDX-License-Identifier: GPL-3.0-or-later
// main() of test programs with emulated GigE cameras. The control port of GigE Vision is fixed, so two such programs on
// one host would drive each other's cameras: each one moves into a network namespace of its own where the system
// permits it, and shares the host's loopback otherwise (ctest then runs one at a time).
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/support/gige_test_support.h"
#include "tests/support/private_network.h"
#include "tests/support/timed_tests.h"

namespace {

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
  todbench::testing_support::enter_private_network();
  return todbench::testing_support::run_timed_tests(argv);
}
