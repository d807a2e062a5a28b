// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb/usbfs_text.h"

#include <algorithm>

namespace todbench {
namespace {

std::string three_digits(int number) {
  std::string text = std::to_string(number);
  return std::string(3 - std::min<std::size_t>(3, text.size()), '0') + text;
}

std::string hexadecimal(std::uint8_t byte) {
  constexpr char digits[] = "0123456789abcdef";
  return {digits[byte >> 4U], digits[byte & 0xFU]};
}

std::string speed_text(UsbSpeed speed) {
  switch (speed) {
    case UsbSpeed::low:
      return "1.5";
    case UsbSpeed::full:
      return "12";
    case UsbSpeed::high:
      return "480";
    default:
      return "5000";
  }
}

}  // namespace

std::string usbfs_node(int number) {
  return "/dev/bus/usb/001/" + three_digits(number);
}

std::string usbfs_sys_path(int number) {
  return "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number);
}

std::string usbfs_description(const UsbDescriptors& d, int number) {
  const auto text = [&](std::size_t offset) {
    const std::size_t index = d.device.at(offset);
    return index >= 1 && index <= d.strings.size() ? d.strings[index - 1] : std::string();
  };
  const std::string vendor = hexadecimal(d.device.at(9)) + hexadecimal(d.device.at(8));
  const std::string product = hexadecimal(d.device.at(11)) + hexadecimal(d.device.at(10));
  std::string descriptors;
  for (const auto byte : d.device) descriptors += hexadecimal(byte);
  for (const auto byte : d.configuration) descriptors += hexadecimal(byte);
  const std::string node = "bus/usb/001/" + three_digits(number);
  return "P: " + usbfs_sys_path(number) + "\nN: " + node + "\nE: DEVNAME=/dev/" + node +
         "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: BUSNUM=001\nE: DEVNUM=" + three_digits(number) +
         "\nE: ID_VENDOR_ID=" + vendor + "\nE: ID_MODEL_ID=" + product +
         "\nA: busnum=1\\n\nA: devnum=" + std::to_string(number) + "\\n\nA: speed=" + speed_text(d.speed) +
         "\\n\nA: bConfigurationValue=1\\n\nA: idVendor=" + vendor + "\\n\nA: idProduct=" + product +
         "\\n\nA: manufacturer=" + text(14) + "\\n\nA: product=" + text(15) + "\\n\nA: serial=" + text(16) +
         "\\n\nH: descriptors=" + descriptors + "\n\n";
}

}  // namespace todbench
