// Plugs a model of a USB device into an emulated usbfs: clients under umockdev's preload library (libusb, Aravis)
// open its node, claim interfaces, and submit and reap transfers as with the kernel.
#pragma once

#include <memory>
#include <string>

#include "acquisition/core/result.h"
#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// A device in a port, from creation to unplug() or destruction. Methods may be called from any thread.
///
/// As with the kernel: transfers of an endpoint are performed in the order of submission, endpoints go on at the same
/// time, a discarded transfer ends as ENOENT, a claimed interface is EBUSY to the next program, and pulling the cable
/// ends every transfer as ESHUTDOWN and every call as ENODEV, while udev announces the removal. Not as with the kernel:
/// poll() on the node is always ready, so that a REAPURBNDELAY with nothing to reap waits for up to 0.3 ms before it
/// says EAGAIN; a client that polls does not spin. Isochronous and interrupt transfers are refused.
class PluggedUsbDevice {
 public:
  /// Errors: `internal` (the emulated file system refuses).
  [[nodiscard]] static Result<std::unique_ptr<PluggedUsbDevice>> plug(std::shared_ptr<MockSystem> system,
                                                                      std::shared_ptr<UsbDevice> device);
  /// Unplugs it.
  ~PluggedUsbDevice();
  PluggedUsbDevice(const PluggedUsbDevice&) = delete;
  PluggedUsbDevice& operator=(const PluggedUsbDevice&) = delete;

  /// "/dev/bus/usb/001/051" as clients under the preload library see it.
  [[nodiscard]] std::string node() const;
  /// Pulls the cable.
  void unplug();

 private:
  struct State;
  PluggedUsbDevice(std::shared_ptr<MockSystem> system, std::shared_ptr<State> state);
  std::shared_ptr<MockSystem> system_;
  std::shared_ptr<State> state_;  ///< shared with the emulated system, whose clients ask on when the device has gone
};

}  // namespace todbench
