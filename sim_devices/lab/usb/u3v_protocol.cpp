// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb/u3v_protocol.h"

#include <zlib.h>

namespace todbench::u3v {

UsbBytes zipped(std::string_view name, std::string_view content) {
  const std::span data(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  // Fields common to local header and directory entry: version, flags, method 0, time, date, crc, sizes, name.
  UsbBytes common;
  for (const unsigned word : {20U, 0U, 0U, 0U, 0x21U}) put(common, static_cast<std::uint16_t>(word));
  put(common, static_cast<std::uint32_t>(::crc32(0, data.data(), static_cast<uInt>(data.size()))));
  put(common, static_cast<std::uint32_t>(data.size()));
  put(common, static_cast<std::uint32_t>(data.size()));
  put(common, static_cast<std::uint16_t>(name.size()));
  put(common, std::uint16_t{0});
  UsbBytes zip;
  zip.reserve(2 * (64 + name.size()) + data.size() + 64);
  put(zip, std::uint32_t{0x04034B50});  // "PK", 3, 4
  zip.insert(zip.end(), common.begin(), common.end());
  zip.insert(zip.end(), name.begin(), name.end());
  zip.insert(zip.end(), data.begin(), data.end());
  const auto directory = static_cast<std::uint32_t>(zip.size());
  zip.insert(zip.end(), {'P', 'K', 1, 2, 20, 0});
  zip.insert(zip.end(), common.begin(), common.end());
  zip.insert(zip.end(), 14, 0);  // comment, disk, attributes, offset of the local header
  zip.insert(zip.end(), name.begin(), name.end());
  const auto directory_size = static_cast<std::uint32_t>(zip.size() - directory);
  zip.insert(zip.end(), {'P', 'K', 5, 6, 0, 0, 0, 0, 1, 0, 1, 0});
  put(zip, directory_size);
  put(zip, directory);
  put(zip, std::uint16_t{0});
  return zip;
}

UsbDescriptors descriptors_of(const U3vCameraConfig& config) {
  UsbDescriptors d;
  d.device = {18, 1, 0x00, 0x02, 0xEF, 2, 1, 64, 0x09, 0x12, 0x02, 0x00, 0x00, 0x01, 1, 2, 3, 1};
  d.configuration = {9,  2,    0,          0, 2,    1,    0, 0x80, 250,  // configuration
                     8,  11,   0,          2, 0xEF, 5,    0, 0,          // association
                     9,  4,    0,          0, 2,    0xEF, 5, 0,    0,    // control
                     20, 0x24, 1,          1, 0,    1,    0, 0,    0,   1,           0, 4,    1,    2,
                     0,  5,    0,          3, 0,    0x04,  // device information
                     7,  5,    control_in, 2, 0x00, 0x02, 0, 7,    5,   control_out, 2, 0x00, 0x02, 0,  // its endpoints
                     9,  4,    1,          0, 1,    0xEF, 5, 2,    0,                                   // stream
                     7,  5,    stream_in,  2, 0x00, 0x02, 0};
  d.configuration[2] = static_cast<std::uint8_t>(d.configuration.size());
  // The GUID is the vendor's number and the serial number (USB3 Vision 1.0, section 4.3.1).
  d.strings = {config.vendor, config.model, config.usb_serial.value_or(config.serial), "1209" + config.serial,
               config.firmware};
  d.speed = UsbSpeed::high;
  return d;
}

}  // namespace todbench::u3v
