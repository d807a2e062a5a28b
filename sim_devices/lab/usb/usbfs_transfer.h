// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer of the emulated usbfs, from submission by a client until it is reaped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>

#include "sim_devices/lab/usb/usb_device.h"

// As declared in umockdev.h.
struct _UMockdevIoctlClient;
struct _UMockdevIoctlData;
using UMockdevIoctlClient = _UMockdevIoctlClient;
using UMockdevIoctlData = _UMockdevIoctlData;

namespace todbench {

/// Size of a setup packet, which precedes the data of a control transfer.
inline constexpr std::size_t usb_setup_size = 8;

/// Transfer between submission and reaping. Memory of the client is accessed only while one of its calls is served.
struct UsbfsTransfer {
  UMockdevIoctlClient* client = nullptr;
  UMockdevIoctlData* urb = nullptr;
  UMockdevIoctlData* buffer = nullptr;  ///< null for a transfer without data
  unsigned type = 0;                    ///< USBDEVFS_URB_TYPE_...
  std::uint8_t endpoint = 0;
  int buffer_length = 0;
  UsbBytes sent;  ///< data from the client; for a control transfer the setup packet comes first
  std::stop_source cancelled;
  // Result:
  int status = 0;
  UsbBytes received;
  std::size_t actual = 0;

  UsbfsTransfer() = default;
  UsbfsTransfer(const UsbfsTransfer&) = delete;
  UsbfsTransfer& operator=(const UsbfsTransfer&) = delete;
  ~UsbfsTransfer();
  [[nodiscard]] bool is_control() const;
  /// Returns whether the direction is from device to host.
  [[nodiscard]] bool is_in() const;
};
using UsbfsTransferPtr = std::unique_ptr<UsbfsTransfer>;

/// Returns the setup packet. Precondition: at least usb_setup_size bytes.
[[nodiscard]] UsbSetup usb_setup_of(const UsbBytes& bytes);

/// Returns the client's memory to which a pointer at `offset` of `data` refers; null if unreadable. Caller unrefs it.
[[nodiscard]] UMockdevIoctlData* client_memory(UMockdevIoctlData* data, std::size_t offset, std::size_t size);

/// Performs a transfer with the device. Blocks until the transfer is finished or cancelled.
void exchange(UsbDevice& device, UsbfsTransfer& transfer);

/// Writes the result into the memory of the client and returns the URB address to the client. Returns 0 or an errno.
[[nodiscard]] int hand_over(UMockdevIoctlClient* client, UsbfsTransfer& transfer);

}  // namespace todbench
