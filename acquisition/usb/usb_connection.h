// SPDX-License-Identifier: GPL-3.0-or-later
// Owners of libusb's objects: a context, its devices, and an opened device with its claimed interface.
#pragma once

#include <libusb.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/usb/seek_protocol.h"

namespace todbench {

/// A libusb context, shared by all objects created from it, because libusb requires that the context is destroyed last.
using UsbContext = std::shared_ptr<libusb_context>;
/// Creates a context. Error: `io`.
[[nodiscard]] Result<UsbContext> usb_context();

struct UsbDeviceDeleter {
  void operator()(libusb_device* device) const { libusb_unref_device(device); }
};
using UsbDevicePtr = std::unique_ptr<libusb_device, UsbDeviceDeleter>;

/// Returns the text of a libusb error, for people.
[[nodiscard]] std::string usb_error_text(int error);

/// A Seek camera on the bus, not opened.
struct SeekOnBus {
  UsbDevicePtr device;
  SeekModel model = SeekModel::compact;
  std::string address;  ///< "/dev/bus/usb/001/004"
};
/// Lists the Seek cameras on the bus. Error: `io` (libusb cannot list the devices).
[[nodiscard]] Result<std::vector<SeekOnBus>> seek_cameras(libusb_context* context);

/// An opened camera with interface 0 claimed. Owns it and releases it on destruction. One thread at a time.
class UsbConnection {
 public:
  /// Opens a camera. Error: `not_found`: access denied (the message contains the remedy), busy, or unplugged.
  [[nodiscard]] static Result<UsbConnection> open(const SeekOnBus& camera);

  /// Performs one vendor request to the interface. Returns the bytes read. Errors: `disconnected`, `timeout`, `io`.
  [[nodiscard]] Result<std::vector<std::uint8_t>> control(const SeekTransfer& transfer);
  /// Reads up to `bytes` from the camera's bulk endpoint; fewer if the camera ends the transfer early. Errors as
  /// control().
  [[nodiscard]] Result<std::vector<std::uint8_t>> bulk_in(std::size_t bytes, std::chrono::milliseconds timeout);

  /// Returns the serial number of the descriptors or of the chip. Errors: `not_found` (none), those of control().
  [[nodiscard]] Result<std::string> serial_number();
  [[nodiscard]] Result<std::string> firmware();
  [[nodiscard]] libusb_device_handle* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(libusb_device_handle* handle) const {
      libusb_release_interface(handle, 0);
      libusb_close(handle);
    }
  };
  explicit UsbConnection(libusb_device_handle* handle) : handle_(handle) {}
  std::unique_ptr<libusb_device_handle, Close> handle_;
};

}  // namespace todbench
