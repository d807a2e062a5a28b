// SPDX-License-Identifier: GPL-3.0-or-later
// main() of the tests of the window: an application without a screen unless QT_QPA_PLATFORM names one, and a network
// of its own where the system permits it, because the control port of GigE Vision is fixed.
#include <gmock/gmock.h>

#include "bench/gui/views/plain_numbers.h"
#include "tests/bench/gui/watched_application.h"
#include "tests/support/private_network.h"
#include "tests/support/timed_tests.h"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  if (testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();
  todbench::testing_support::enter_private_network();
  if (!qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  const todbench::testing::WatchedApplication application(argc, argv);
  todbench::use_plain_numbers();
  return todbench::testing_support::run_timed_tests(argv);
}
