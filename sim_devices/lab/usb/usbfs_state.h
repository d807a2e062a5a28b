// SPDX-License-Identifier: GPL-3.0-or-later
// State of a plugged USB device, shared by its threads and the calls of its clients. Private to these threads and
// calls.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "sim_devices/lab/usb/usbfs_host.h"
#include "sim_devices/lab/usb/usbfs_transfer.h"

// As declared in umockdev.h.
struct _UMockdevIoctlBase;
using UMockdevIoctlBase = _UMockdevIoctlBase;

namespace todbench {

/// Longest wait of a REAPURBNDELAY for a finished transfer. The client holds its lock on the node during the wait, so
/// submissions from its other threads wait, too.
inline constexpr std::chrono::microseconds usbfs_reap_patience{300};

/// State and threads of a plugged device. One thread per endpoint performs its transfers, and one thread answers the
/// calls that reap. The calls themselves arrive on the thread of the emulated system. All methods are called with the
/// mutex held, except the destructor, end_workers() and the bodies of the threads.
struct PluggedUsbDevice::State {
  std::shared_ptr<UsbDevice> device;  ///< null after unplugging, when the port is gone
  int number = 0;

  std::mutex mutex;  ///< guards all members below
  std::condition_variable_any changed;
  bool unplugged = false;
  std::map<std::uint8_t, std::deque<UsbfsTransferPtr>> waiting;  ///< transfers not yet begun, by endpoint
  std::map<std::uint8_t, UsbfsTransfer*> performing;             ///< present transfer of each endpoint, or null
  std::deque<UsbfsTransferPtr> done;                             ///< finished transfers that wait to be reaped
  std::map<unsigned, UMockdevIoctlClient*> claims;               ///< client that claimed an interface, by interface
  struct Reaper {
    UMockdevIoctlClient* client;
    std::optional<std::chrono::steady_clock::time_point> patience_ends;  ///< empty: waits without limit
  };
  std::list<Reaper> reapers;  ///< calls that wait for a finished transfer

  std::map<std::uint8_t, std::jthread> workers;  ///< one per endpoint, control first
  std::jthread answers;                          ///< completes the calls of reapers

  ~State();
  /// Called after unplugging, when no transfer is submitted any more.
  void end_workers();
  void perform(const std::stop_token& stop, std::uint8_t endpoint);
  void answer_reapers(const std::stop_token& stop);
  [[nodiscard]] UsbfsTransferPtr finished_for(UMockdevIoctlClient* client);
  [[nodiscard]] std::optional<std::pair<int, int>> serve(UMockdevIoctlClient* client);
  [[nodiscard]] int submit(UMockdevIoctlClient* client);
  [[nodiscard]] int discard(UMockdevIoctlClient* client);
  [[nodiscard]] std::pair<int, int> transfer_now(UMockdevIoctlClient* client, unsigned long request);
  [[nodiscard]] int claim(UMockdevIoctlClient* client, std::size_t size, unsigned long request);
  void cancel(UMockdevIoctlClient* client, int status);

  /// Creates the handler of ioctl calls. The handler owns the data of its signals.
  static UMockdevIoctlBase* handler(const std::shared_ptr<State>& state);
  static int on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* data);
  static void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* data);
};

}  // namespace todbench
