// A transfer of the emulated usbfs, from its submission by a client until it is reaped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>

#include "sim_devices/lab/usb/usb_device.h"

// As umockdev.h declares them.
struct _UMockdevIoctlClient;
struct _UMockdevIoctlData;
using UMockdevIoctlClient = _UMockdevIoctlClient;
using UMockdevIoctlData = _UMockdevIoctlData;

namespace todbench {

/// Of a setup packet, which comes before the data of a control transfer.
inline constexpr std::size_t usb_setup_size = 8;

/// A transfer between submission and reaping. What belongs to the client's memory is touched only while one of its
/// calls is being served.
struct UsbfsTransfer {
  UMockdevIoctlClient* client = nullptr;
  UMockdevIoctlData* urb = nullptr;
  UMockdevIoctlData* buffer = nullptr;  ///< null for a transfer without data
  unsigned type = 0;                    ///< USBDEVFS_URB_TYPE_...
  std::uint8_t endpoint = 0;
  int buffer_length = 0;
  UsbBytes sent;  ///< what the client sent; of a control transfer the setup packet first
  std::stop_source cancelled;
  // The outcome:
  int status = 0;
  UsbBytes received;
  std::size_t actual = 0;

  UsbfsTransfer() = default;
  UsbfsTransfer(const UsbfsTransfer&) = delete;
  UsbfsTransfer& operator=(const UsbfsTransfer&) = delete;
  ~UsbfsTransfer();
  [[nodiscard]] bool is_control() const;
  /// From the device to the host.
  [[nodiscard]] bool is_in() const;
};
using UsbfsTransferPtr = std::unique_ptr<UsbfsTransfer>;

/// Precondition: at least usb_setup_size bytes.
[[nodiscard]] UsbSetup usb_setup_of(const UsbBytes& bytes);

/// Memory of the client behind a pointer; null when it cannot be read. To be unreferenced by the caller.
[[nodiscard]] UMockdevIoctlData* client_memory(UMockdevIoctlData* data, std::size_t offset, std::size_t size);

/// Performs a transfer with the device; blocks as long as the device does, or until the transfer is cancelled.
void exchange(UsbDevice& device, UsbfsTransfer& transfer);

/// Writes the outcome into the client's memory and gives it the address of its URB. 0, or an errno.
[[nodiscard]] int hand_over(UMockdevIoctlClient* client, UsbfsTransfer& transfer);

}  // namespace todbench
