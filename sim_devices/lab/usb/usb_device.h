// SPDX-License-Identifier: GPL-3.0-or-later
// Model of a USB device without a bus: descriptors, control requests and bulk transfers. A carrier connects it to a
// host: a usbfs emulation, or a USB/IP server with a real kernel at the other end.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace todbench {

using UsbBytes = std::vector<std::uint8_t>;

/// The setup packet of a control transfer (USB 2.0, section 9.3), in host byte order.
struct UsbSetup {
  std::uint8_t request_type = 0;  ///< bit 7: device to host; bits 5-6: standard, class, vendor; bits 0-4: recipient
  std::uint8_t request = 0;
  std::uint16_t value = 0, index = 0, length = 0;

  [[nodiscard]] bool device_to_host() const { return (request_type & 0x80U) != 0; }
};

/// Signalling speed, with the numbers of the Linux kernel.
enum class UsbSpeed { low = 1, full = 2, high = 3, super = 5 };

/// Descriptors of the device, as on the wire.
struct UsbDescriptors {
  UsbBytes device;                   ///< 18 bytes
  UsbBytes configuration;            ///< configuration, interfaces, endpoints and class descriptors: wTotalLength bytes
  std::vector<std::string> strings;  ///< ASCII; string descriptor k is strings[k - 1]
  UsbSpeed speed = UsbSpeed::high;
};

/// Model of a device. Requests may come from several threads, at most one at a time for the control endpoint and for
/// each bulk endpoint. All received data are untrusted: answer or stall, never assert.
class UsbDevice {
 public:
  virtual ~UsbDevice() = default;
  UsbDevice() = default;
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;

  /// Constant for the life of the device.
  [[nodiscard]] virtual const UsbDescriptors& descriptors() const = 0;

  /// Handles a control request. `data`: the bytes of the OUT stage. Returns the bytes of the IN stage (empty bytes for
  /// an accepted OUT request). If it returns no value, usb_control() answers standard requests and stalls the others.
  /// CLEAR_FEATURE, SET_CONFIGURATION and SET_INTERFACE arrive here first, for their effect.
  [[nodiscard]] virtual std::optional<UsbBytes> control(const UsbSetup& setup, std::span<const std::uint8_t> data) = 0;

  /// One bulk OUT transfer to `endpoint` (0x01 ... 0x0F). Returns false to stall.
  [[nodiscard]] virtual bool bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) = 0;

  /// One bulk IN transfer from `endpoint` (0x81 ... 0x8F) of at most `length` bytes. Waits for bytes or for `stop`.
  /// Fewer bytes than requested are a short packet, which ends the transfer; no bytes are a zero-length packet. No
  /// value: the endpoint stalls, or `stop` was requested; then no byte has been taken.
  [[nodiscard]] virtual std::optional<UsbBytes> bulk_in(std::uint8_t endpoint, std::size_t length,
                                                        std::stop_token stop) = 0;
};

/// Performs a control transfer for a carrier. The device is asked first. Standard requests (USB 2.0, section 9.4) that
/// it leaves are answered from its descriptors: GET_DESCRIPTOR of device, configuration and strings, GET_STATUS,
/// GET_CONFIGURATION, GET_INTERFACE; setting requests are accepted. At most setup.length bytes; no value: STALL.
[[nodiscard]] std::optional<UsbBytes> usb_control(UsbDevice& device, const UsbSetup& setup,
                                                  std::span<const std::uint8_t> data);

}  // namespace todbench
