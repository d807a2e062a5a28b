// SPDX-License-Identifier: GPL-3.0-or-later
// Description of a USB device in sysfs and udev, in umockdev's format.
#pragma once

#include <string>

#include "sim_devices/lab/usb/usb_device.h"

namespace todbench {

/// Returns the node of a device: "/dev/bus/usb/001/051" for device number 51.
[[nodiscard]] std::string usbfs_node(int number);
/// Returns the path of a device below /sys.
[[nodiscard]] std::string usbfs_sys_path(int number);
/// Returns the description of the device as in sysfs, in the format of umockdev. Precondition: a device descriptor of
/// 18 bytes.
[[nodiscard]] std::string usbfs_description(const UsbDescriptors& descriptors, int number);

}  // namespace todbench
