// SPDX-License-Identifier: GPL-3.0-or-later
// Description of a USB device in sysfs and udev, in umockdev's format.
#pragma once

#include <string>

#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// "/dev/bus/usb/001/051" of device number 51.
[[nodiscard]] std::string usbfs_node(int number);
/// Path below /sys.
[[nodiscard]] std::string usbfs_sys_path(int number);
/// Description of the device as in sysfs, in umockdev's format. Precondition: a device descriptor of 18 bytes.
[[nodiscard]] std::string usbfs_description(const UsbDescriptors& descriptors, int number);

}  // namespace todbench
