// SPDX-License-Identifier: GPL-3.0-or-later
// Separate /dev, /sys and udev for programs under the preload library of umockdev. For these programs, emulated devices
// behave like real devices in open, ioctl, mmap and udev.
#pragma once

#include <memory>
#include <string>

#include "acquisition/base/result.h"

struct _UMockdevTestbed;

namespace todbench {

/// Emulated system, one per process: the environment variable UMOCKDEV_DIR states its folder. Attach devices to the
/// system, and destroy them before the system. Methods may be called from any thread, one at a time.
class MockSystem {
 public:
  /// Creates the system.
  [[nodiscard]] static std::shared_ptr<MockSystem> create();
  ~MockSystem();
  MockSystem(const MockSystem&) = delete;
  MockSystem& operator=(const MockSystem&) = delete;

  /// Returns whether this process has loaded the preload library and uses emulated devices. Child processes also use
  /// emulated devices if the environment names the library.
  [[nodiscard]] static bool is_preloaded();
  /// Restarts this program in this process with the preload library. Returns only if the library is already loaded or
  /// cannot be loaded. Call this function first in main(), because open files and threads are lost.
  static void enter();
  /// Returns the value of LD_PRELOAD for a client.
  [[nodiscard]] static std::string preload_library();
  /// Returns the value of UMOCKDEV_DIR for a client.
  [[nodiscard]] std::string folder() const;

  /// Adds devices described in umockdev's format ("P:", "N:", "E:", "A:" lines) and announces them to udev monitors.
  [[nodiscard]] Result<void> add(const std::string& description);
  /// Sends the udev event "add" or "remove" for a device.
  void announce(const std::string& device_path, const std::string& action);
  /// Removes an announced device.
  void remove(const std::string& device_path);

  /// Returns the testbed, for code that attaches ioctl handlers. Owned by this object.
  [[nodiscard]] _UMockdevTestbed* testbed() const { return testbed_; }

 private:
  explicit MockSystem(_UMockdevTestbed* testbed) : testbed_(testbed) {}
  _UMockdevTestbed* testbed_;
};

}  // namespace todbench
