// The inside of a plugged USB device: what its threads and the calls of its clients share. Private to them.
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

// As umockdev.h declares it.
struct _UMockdevIoctlBase;
using UMockdevIoctlBase = _UMockdevIoctlBase;

namespace todbench {

/// How long a REAPURBNDELAY waits for something to reap. The client holds its lock on the node meanwhile: a submission
/// by another of its threads waits as long.
inline constexpr std::chrono::microseconds usbfs_reap_patience{300};

/// Each endpoint has a thread that performs its transfers; calls that reap are answered by one more. The calls
/// themselves come on the thread of the emulated system. Methods but the destructor, end_workers() and the bodies of
/// the threads are called with the mutex held.
struct PluggedUsbDevice::State {
  std::shared_ptr<UsbDevice> device;  ///< null when it was unplugged and its port has gone
  int number = 0;

  std::mutex mutex;  ///< guards what follows
  std::condition_variable_any changed;
  bool unplugged = false;
  std::map<std::uint8_t, std::deque<UsbfsTransferPtr>> waiting;  ///< by endpoint
  std::map<std::uint8_t, UsbfsTransfer*> performing;
  std::deque<UsbfsTransferPtr> done;
  std::map<unsigned, UMockdevIoctlClient*> claims;
  struct Reaper {
    UMockdevIoctlClient* client;
    std::optional<std::chrono::steady_clock::time_point> patience_ends;  ///< nothing: waits for ever
  };
  std::list<Reaper> reapers;  ///< calls that wait for something to reap

  std::map<std::uint8_t, std::jthread> workers;  ///< one per endpoint, control first
  std::jthread answers;                          ///< completes the calls of reapers

  ~State();
  /// After unplugging: nothing is submitted any more.
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

  /// The handler owns what its signals are given.
  static UMockdevIoctlBase* handler(const std::shared_ptr<State>& state);
  static int on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* data);
  static void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* data);
};

}  // namespace todbench
