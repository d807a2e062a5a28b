// How a USB device looks in sysfs and udev, as umockdev wants it described.
#pragma once

#include <string>

#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// "/dev/bus/usb/001/051" of device number 51.
[[nodiscard]] std::string usbfs_node(int number);
/// Below /sys.
[[nodiscard]] std::string usbfs_sys_path(int number);
/// The device as sysfs shows it, in umockdev's format. Precondition: a device descriptor of 18 bytes.
[[nodiscard]] std::string usbfs_description(const UsbDescriptors& descriptors, int number);

}  // namespace todbench
