// SPDX-License-Identifier: GPL-3.0-or-later
// main() of the system tests. Where the system permits it, the test and the programs it starts have a network and a
// table of mounts of their own: the control port of GigE Vision is fixed, and a small disk is a mount.
#include <gmock/gmock.h>

#include "tests/support/private_network.h"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  todbench::testing_support::enter_private_network_and_mounts();
  return RUN_ALL_TESTS();
}
