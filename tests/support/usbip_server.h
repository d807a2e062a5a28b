// SPDX-License-Identifier: GPL-3.0-or-later
// A USB device served to a kernel over USB/IP: the device's side of the protocol of the Linux drivers vhci-hcd and
// usbip-core (Documentation/usb/usbip_protocol.rst), control and bulk transfers.
#pragma once

#include <memory>

#include "acquisition/base/result.h"
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// Serves from creation to destruction, on threads of its own. Everything that arrives is checked: an impossible
/// command ends the connection, and no transfer allocates more than 16 MiB.
class UsbIpServer {
 public:
  /// `socket`: connected, stream; owned from now on. Errors: `invalid_input` for a socket that is none.
  [[nodiscard]] static Result<std::unique_ptr<UsbIpServer>> serve(std::shared_ptr<UsbDevice> device, int socket);
  /// Closes the connection: the kernel sees the device unplugged.
  ~UsbIpServer();
  UsbIpServer(const UsbIpServer&) = delete;
  UsbIpServer& operator=(const UsbIpServer&) = delete;

  /// False after the other side closed the connection or sent nonsense.
  [[nodiscard]] bool connected() const;

 private:
  struct State;
  explicit UsbIpServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Plugs a device into a port of this system's virtual USB host controller (module vhci-hcd, needs root). Errors:
/// `not_found` (no such module, port in use).
[[nodiscard]] Result<std::unique_ptr<UsbIpServer>> plug_into_kernel(std::shared_ptr<UsbDevice> device, int port);

}  // namespace todbench
