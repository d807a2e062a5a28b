// SPDX-License-Identifier: GPL-3.0-or-later
// Connection of a model of a USB device to an emulated usbfs. Clients under the preload library of umockdev (libusb,
// Aravis) open its node, claim interfaces, and submit and reap transfers as with the kernel.
#pragma once

#include <memory>
#include <string>

#include "acquisition/base/result.h"
#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// Device in a USB port, from creation to unplug() or destruction. Methods may be called from any thread.
///
/// As with the kernel, transfers of an endpoint are performed in the order of submission, and endpoints run in
/// parallel. A discarded transfer ends with ENOENT. A second program that claims a claimed interface receives EBUSY.
/// Unplugging ends every transfer with ESHUTDOWN and every call with ENODEV, and udev announces the removal. Unlike the
/// kernel, poll() on the node is always ready. A REAPURBNDELAY without a finished transfer therefore waits for up to
/// 0.3 ms before it returns EAGAIN, so that a polling client does not spin. Isochronous and interrupt transfers are
/// rejected.
class PluggedUsbDevice {
 public:
  /// Plugs the device in. Errors: `internal` (the emulated file system rejects it).
  [[nodiscard]] static Result<std::unique_ptr<PluggedUsbDevice>> plug(std::shared_ptr<MockSystem> system,
                                                                      std::shared_ptr<UsbDevice> device);
  /// Unplugs the device.
  ~PluggedUsbDevice();
  PluggedUsbDevice(const PluggedUsbDevice&) = delete;
  PluggedUsbDevice& operator=(const PluggedUsbDevice&) = delete;

  /// Returns "/dev/bus/usb/001/051", the path for clients under the preload library.
  [[nodiscard]] std::string node() const;
  /// Pulls the cable.
  void unplug();

 private:
  struct State;
  PluggedUsbDevice(std::shared_ptr<MockSystem> system, std::shared_ptr<State> state);
  std::shared_ptr<MockSystem> system_;
  std::shared_ptr<State> state_;  ///< shared with the emulated system, whose clients still call after unplugging
};

}  // namespace todbench
