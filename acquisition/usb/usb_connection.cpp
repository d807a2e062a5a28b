// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/usb/usb_connection.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>

namespace todbench {
namespace {

constexpr unsigned control_timeout_ms = 1000;
constexpr std::uint8_t vendor_interface_out =
    LIBUSB_ENDPOINT_OUT | static_cast<unsigned>(LIBUSB_REQUEST_TYPE_VENDOR) | LIBUSB_RECIPIENT_INTERFACE;
constexpr std::uint8_t vendor_interface_in =
    LIBUSB_ENDPOINT_IN | static_cast<unsigned>(LIBUSB_REQUEST_TYPE_VENDOR) | LIBUSB_RECIPIENT_INTERFACE;

tl::unexpected<Error> failed(const std::string& doing, int error) {
  const auto code = error == LIBUSB_ERROR_NO_DEVICE ? ErrorCode::disconnected
                    : error == LIBUSB_ERROR_TIMEOUT ? ErrorCode::timeout
                                                    : ErrorCode::io;
  return fail(code, doing + ": " + usb_error_text(error));
}

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  constexpr char digits[] = "0123456789ABCDEF";
  std::string text;
  for (const auto byte : bytes) {
    text += digits[byte >> 4U];
    text += digits[byte & 0xFU];
  }
  return text;
}

}  // namespace

std::string usb_error_text(int error) {
  return libusb_strerror(static_cast<libusb_error>(error));
}

Result<UsbContext> usb_context() {
  libusb_context* context = nullptr;
  if (const int error = libusb_init(&context); error != 0) {
    return fail(ErrorCode::io, "starting libusb: " + usb_error_text(error));
  }
  return UsbContext(context, &libusb_exit);
}

Result<std::vector<SeekOnBus>> seek_cameras(libusb_context* context) {
  libusb_device** devices = nullptr;
  const auto count = libusb_get_device_list(context, &devices);
  if (count < 0) return failed("listing USB devices", static_cast<int>(count));
  std::vector<SeekOnBus> cameras;
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[k], &descriptor) != 0) continue;
    const auto model = seek_model(descriptor.idVendor, descriptor.idProduct);
    if (!model) continue;
    cameras.push_back({UsbDevicePtr(libusb_ref_device(devices[k])), *model,
                       fmt::format("/dev/bus/usb/{:03}/{:03}", libusb_get_bus_number(devices[k]),
                                   libusb_get_device_address(devices[k]))});
  }
  libusb_free_device_list(devices, 1);
  return cameras;
}

Result<UsbConnection> UsbConnection::open(const SeekOnBus& camera) {
  libusb_device_handle* raw = nullptr;
  if (const int error = libusb_open(camera.device.get(), &raw); error != 0) {
    std::string message = camera.address + ": " + usb_error_text(error);
    if (error == LIBUSB_ERROR_ACCESS) message += "; a udev rule is missing. Run todbench doctor, which prints it";
    return fail(ErrorCode::not_found, message);
  }
  libusb_set_auto_detach_kernel_driver(raw, 1);
  if (const int error = libusb_claim_interface(raw, 0); error != 0) {
    libusb_close(raw);
    const std::string why = error == LIBUSB_ERROR_BUSY ? "busy: another program uses it" : usb_error_text(error);
    return fail(ErrorCode::not_found, camera.address + ": " + why);
  }
  return UsbConnection(raw);
}

Result<std::vector<std::uint8_t>> UsbConnection::control(const SeekTransfer& transfer) {
  std::vector<std::uint8_t> data = transfer.data;
  const int done = libusb_control_transfer(handle(), transfer.reads() ? vendor_interface_in : vendor_interface_out,
                                           static_cast<std::uint8_t>(transfer.request), 0, 0, data.data(),
                                           static_cast<std::uint16_t>(data.size()), control_timeout_ms);
  const std::string doing = "request " + std::to_string(static_cast<int>(transfer.request));
  if (done < 0) return failed(doing, done);
  if (static_cast<std::size_t>(done) != data.size()) {
    return fail(ErrorCode::io,
                doing + ": transferred " + std::to_string(done) + " of " + std::to_string(data.size()) + " bytes");
  }
  return data;
}

Result<std::vector<std::uint8_t>> UsbConnection::bulk_in(std::size_t bytes, std::chrono::milliseconds timeout) {
  std::vector<std::uint8_t> data(bytes);
  int done = 0;
  const int error = libusb_bulk_transfer(handle(), seek_bulk_in_endpoint, data.data(), static_cast<int>(bytes), &done,
                                         static_cast<unsigned>(timeout.count()));
  if (error != 0) return failed("reading a frame", error);
  data.resize(static_cast<std::size_t>(done));
  return data;
}

Result<std::string> UsbConnection::serial_number() {
  libusb_device_descriptor descriptor{};
  libusb_get_device_descriptor(libusb_get_device(handle()), &descriptor);
  std::array<unsigned char, 128> text{};
  if (descriptor.iSerialNumber != 0) {
    const int size = libusb_get_string_descriptor_ascii(handle(), descriptor.iSerialNumber, text.data(),
                                                        static_cast<int>(text.size()));
    if (size > 0) return std::string(text.begin(), text.begin() + size);
  }
  const auto chip = control({SeekRequest::read_chip_id, std::vector<std::uint8_t>(12)});
  if (!chip) return fail("reading the chip number", chip.error());
  // A chip without a programmed number: every other such chip has the same.
  const auto blank = [&chip](std::uint8_t value) {
    return std::all_of(chip->begin(), chip->end(), [value](std::uint8_t byte) { return byte == value; });
  };
  if (blank(0x00) || blank(0xFF))
    return fail(ErrorCode::not_found, "the camera has neither a serial number nor a chip number");
  return hexadecimal(*chip);
}

Result<std::string> UsbConnection::firmware() {
  const auto version = control({SeekRequest::get_firmware_info, std::vector<std::uint8_t>(4)});
  if (!version) return fail("reading the firmware version", version.error());
  std::string text;
  for (const auto part : *version) {
    if (!text.empty()) text += '.';
    text += std::to_string(part);
  }
  return text;
}

}  // namespace todbench
