// SPDX-License-Identifier: GPL-3.0-or-later
// A race on purpose. The thread sanitizer has to see it in a program that runs as the tests with emulated cameras do:
// behind umockdev's preload library. A sanitizer that is blind there would make every one of those tests pass.
#include <cstdio>
#include <thread>

#include "sim_devices/lab/device_nodes/mock_system.h"

namespace {

/// Two threads change the same number, each for itself: neither waits for the other.
int raced() {
  int number = 0;
  std::thread other([&] { ++number; });
  ++number;
  other.join();
  return number;
}

}  // namespace

int main() {
  todbench::MockSystem::enter();
  if (!todbench::MockSystem::is_preloaded()) {
    std::fprintf(stderr, "umockdev's preload library cannot be loaded\n");
    return 1;
  }
  const auto system = todbench::MockSystem::create();
  std::printf("%d in %s\n", raced(), system->folder().c_str());
  return 0;
}
