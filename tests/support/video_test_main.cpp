// SPDX-License-Identifier: GPL-3.0-or-later
// main() of test programs with emulated video cameras: they run under umockdev's preload library.
#include <gmock/gmock.h>

#include <cstdio>

#include "sim_devices/lab/device_nodes/mock_system.h"
#include "tests/support/timed_tests.h"

int main(int argc, char** argv) {
  todbench::MockSystem::enter();
  if (!todbench::MockSystem::is_preloaded()) {
    std::fprintf(stderr, "umockdev's preload library cannot be loaded\n");
    return 1;
  }
  testing::InitGoogleMock(&argc, argv);
  return todbench::testing_support::run_timed_tests(argv);
}
