// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {
namespace {

// USB 2.0, tables 9-4 and 9-5.
enum StandardRequest : std::uint8_t {
  get_status = 0,
  clear_feature = 1,
  set_feature = 3,
  set_address = 5,
  get_descriptor = 6,
  get_configuration = 8,
  set_configuration = 9,
  get_interface = 10,
  set_interface = 11,
};
constexpr std::uint8_t descriptor_device = 1, descriptor_configuration = 2, descriptor_string = 3;
constexpr std::uint8_t english_us[] = {0x09, 0x04};
constexpr std::size_t longest_string = 126;  // bLength is one byte: 2 + 2 * 126 = 254

UsbBytes string_descriptor(const std::string& text) {
  UsbBytes bytes{0, descriptor_string};
  for (const char c : text.substr(0, longest_string)) {
    bytes.push_back(static_cast<std::uint8_t>(c));
    bytes.push_back(0);
  }
  bytes[0] = static_cast<std::uint8_t>(bytes.size());
  return bytes;
}

std::optional<UsbBytes> descriptor(const UsbDescriptors& descriptors, std::uint16_t value) {
  const std::size_t index = value & 0xFFU;
  switch (value >> 8U) {
    case descriptor_device:
      return descriptors.device;
    case descriptor_configuration:
      return index == 0 ? std::optional(descriptors.configuration) : std::nullopt;
    case descriptor_string:
      if (index == 0) return UsbBytes{4, descriptor_string, english_us[0], english_us[1]};
      if (index <= descriptors.strings.size()) return string_descriptor(descriptors.strings[index - 1]);
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

std::optional<UsbBytes> standard_answer(const UsbDescriptors& descriptors, const UsbSetup& setup) {
  switch (setup.request) {
    case get_status:
      return UsbBytes{0, 0};
    case get_descriptor:
      return descriptor(descriptors, setup.value);
    case get_configuration:
      return UsbBytes{1};
    case get_interface:
      return UsbBytes{0};
    case clear_feature:
    case set_feature:
    case set_address:
    case set_configuration:
    case set_interface:
      return UsbBytes{};
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<UsbBytes> usb_control(UsbDevice& device, const UsbSetup& setup, std::span<const std::uint8_t> data) {
  auto answer = device.control(setup, data);
  const bool standard = (setup.request_type & 0x60U) == 0;
  if (!answer && standard) answer = standard_answer(device.descriptors(), setup);
  if (answer && answer->size() > setup.length) answer->resize(setup.length);
  return answer;
}

}  // namespace todbench
