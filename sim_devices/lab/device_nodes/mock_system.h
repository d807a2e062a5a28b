// A /dev, /sys and udev of its own for programs that run under umockdev's preload library: emulated devices are real to
// them, to open, ioctl, mmap and udev.
#pragma once

#include <memory>
#include <string>

#include "acquisition/core/result.h"

struct _UMockdevTestbed;

namespace todbench {

/// One per process: it says through the environment variable UMOCKDEV_DIR where it is. Devices attach to it; it is
/// destroyed after them. Methods may be called from any thread, one at a time.
class MockSystem {
 public:
  [[nodiscard]] static std::shared_ptr<MockSystem> create();
  ~MockSystem();
  MockSystem(const MockSystem&) = delete;
  MockSystem& operator=(const MockSystem&) = delete;

  /// Whether *this* process looks at emulated devices: the preload library is loaded. Its children do when the
  /// environment names it.
  [[nodiscard]] static bool is_preloaded();
  /// Starts this program again, in this process, with the preload library; returns only when it is loaded already or
  /// cannot be. Files and threads of the process are gone then: call it first.
  static void enter();
  /// What LD_PRELOAD has to be for a client.
  [[nodiscard]] static std::string preload_library();
  /// What UMOCKDEV_DIR has to be for a client.
  [[nodiscard]] std::string folder() const;

  /// Adds devices described in umockdev's format ("P:", "N:", "E:", "A:" lines) and announces them to udev monitors.
  [[nodiscard]] Result<void> add(const std::string& description);
  /// Announces "add" or "remove" of a device.
  void announce(const std::string& device_path, const std::string& action);
  /// Removes a device that was announced.
  void remove(const std::string& device_path);

  /// For what attaches ioctl handlers. Owned by this.
  [[nodiscard]] _UMockdevTestbed* testbed() const { return testbed_; }

 private:
  explicit MockSystem(_UMockdevTestbed* testbed) : testbed_(testbed) {}
  _UMockdevTestbed* testbed_;
};

}  // namespace todbench
