// SPDX-License-Identifier: GPL-3.0-or-later
// Model of a USB device without a bus: descriptors, control requests and bulk transfers. A usbfs emulation, or a USB/IP
// server with a real kernel at the other end, connects the model to a host.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace todbench {

using UsbBytes = std::vector<std::uint8_t>;

/// Setup packet of a control transfer (USB 2.0, section 9.3), in host byte order.
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
/// each bulk endpoint. All received data are untrusted: an implementation responds or stalls, and never asserts.
class UsbDevice {
 public:
  virtual ~UsbDevice() = default;
  UsbDevice() = default;
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;

  /// Returns the descriptors, which are constant for the life of the device.
  [[nodiscard]] virtual const UsbDescriptors& descriptors() const = 0;

  /// Handles a control request. `data`: the bytes of the OUT stage. Returns the bytes of the IN stage (empty bytes for
  /// an accepted OUT request). For a request without a returned value, usb_control() handles standard requests and
  /// stalls other requests. CLEAR_FEATURE, SET_CONFIGURATION and SET_INTERFACE are passed to this function first, so
  /// that the device can react.
  [[nodiscard]] virtual std::optional<UsbBytes> control(const UsbSetup& setup, std::span<const std::uint8_t> data) = 0;

  /// Handles one bulk OUT transfer to `endpoint` (0x01 ... 0x0F). Returns false to stall.
  [[nodiscard]] virtual bool bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) = 0;

  /// Handles one bulk IN transfer from `endpoint` (0x81 ... 0x8F) of at most `length` bytes. Waits for bytes or for
  /// `stop`. Fewer bytes than requested are a short packet, which ends the transfer; an empty vector is a zero-length
  /// packet. Returns no value, and consumes no byte, if the endpoint stalls or `stop` was requested.
  [[nodiscard]] virtual std::optional<UsbBytes> bulk_in(std::uint8_t endpoint, std::size_t length,
                                                        std::stop_token stop) = 0;
};

/// Performs a control transfer for the code that connects the device to a host. The request is passed to the device
/// first. Standard requests (USB 2.0, section 9.4) that the device does not handle are answered from its descriptors:
/// GET_DESCRIPTOR of device, configuration and strings, GET_STATUS, GET_CONFIGURATION, GET_INTERFACE; requests that set
/// values are accepted. Returns at most setup.length bytes; no value means STALL.
[[nodiscard]] std::optional<UsbBytes> usb_control(UsbDevice& device, const UsbSetup& setup,
                                                  std::span<const std::uint8_t> data);

}  // namespace todbench
