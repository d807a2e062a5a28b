// SPDX-License-Identifier: GPL-3.0-or-later
// USB3 Vision and GenCP of the emulated camera: addresses, codes, little-endian fields, descriptors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim_devices/lab/usb/u3v_camera.h"

namespace todbench::u3v {

inline constexpr std::uint8_t control_in = 0x81, control_out = 0x01, stream_in = 0x82;

// GenCP 1.1, sections 4.3 and 4.4: bootstrap registers of every device, and the addresses of this device's tables.
inline constexpr std::uint64_t abrm_vendor = 0x4, abrm_model = 0x44, abrm_family = 0x84, abrm_version = 0xC4,
                               abrm_serial = 0x144, abrm_capability = 0x1C4, abrm_response_time = 0x1CC,
                               abrm_manifest = 0x1D0, abrm_sbrm = 0x1D8, abrm_tick = 0x1FC;
inline constexpr std::uint64_t sbrm = 0x1000, sirm = 0x1100, eirm = 0x1200, manifest = 0x2000;
inline constexpr std::uint64_t camera_registers = 0x10000, description_address = 0x100000;
inline constexpr std::size_t bootstrap_size = 0x3000, camera_size = 0x100;
// Offsets in the stream interface registers (USB3 Vision 1.0, table 5-8).
inline constexpr std::uint64_t si_info = 0x0, si_control = 0x4, si_payload = 0x8, si_leader = 0x10, si_trailer = 0x14;
inline constexpr std::size_t leader_size = 52, trailer_size = 32;

// The camera's own registers. A client may write the registers from reg_pixel_format to the last one before the first
// register of the sensor (reg_scale).
inline constexpr std::uint64_t reg_width = 0x00, reg_height = 0x04, reg_offset_x = 0x08, reg_offset_y = 0x0C,
                               reg_pixel_format = 0x10, reg_largest_count = 0x14, reg_acquisition_mode = 0x18,
                               reg_acquisition = 0x1C, reg_period_us = 0x20, reg_ir_format = 0x24, reg_nuc_mode = 0x28,
                               reg_nuc = 0x2C, reg_scale = 0x40, reg_offset = 0x48, reg_payload_size = 0x50;

// GenCP 1.1, section 4.2.
inline constexpr std::uint32_t command_magic = 0x43563355, leader_magic = 0x4C563355, trailer_magic = 0x54563355;
inline constexpr std::uint16_t read_memory = 0x0800, write_memory = 0x0802;
inline constexpr std::uint16_t status_ok = 0, status_not_implemented = 0x8001, status_invalid_parameter = 0x8002,
                               status_invalid_address = 0x8003, status_write_protected = 0x8004;
inline constexpr std::size_t header_size = 12;
inline constexpr std::size_t longest_transfer = 1024 + header_size;

/// Appends a number, lowest byte first.
template <typename T>
void put(UsbBytes& bytes, T value) {
  for (std::size_t k = 0; k < sizeof(T); ++k) {
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * k) & 0xFFU));
  }
}

/// Returns the number at an offset, lowest byte first. Precondition: the number lies within the bytes.
template <typename T>
T get(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < sizeof(T); ++k) value |= std::uint64_t{bytes[offset + k]} << (8 * k);
  return static_cast<T>(value);
}

/// Registers in memory, little-endian.
class Registers {
 public:
  Registers(std::uint64_t base, std::size_t size) : base_(base), bytes_(size) {}
  [[nodiscard]] bool contains(std::uint64_t address, std::size_t size) const {
    return address >= base_ && address - base_ <= bytes_.size() && size <= bytes_.size() - (address - base_);
  }
  [[nodiscard]] std::span<std::uint8_t> at(std::uint64_t address, std::size_t size) {
    return std::span(bytes_).subspan(address - base_, size);
  }
  template <typename T>
  void set(std::uint64_t address, T value) {
    UsbBytes bytes;
    put(bytes, value);
    std::copy(bytes.begin(), bytes.end(), at(address, bytes.size()).begin());
  }
  void set(std::uint64_t address, const std::string& text) {
    std::copy_n(text.begin(), std::min<std::size_t>(text.size(), 63), at(address, 64).begin());
  }
  [[nodiscard]] std::uint32_t u32(std::uint64_t address) { return get<std::uint32_t>(at(address, 4), 0); }

 private:
  std::uint64_t base_;
  UsbBytes bytes_;
};

/// Returns a ZIP archive with one stored file, the form in which some cameras store their GenICam description.
[[nodiscard]] UsbBytes zipped(std::string_view name, std::string_view content);

/// Returns the descriptors of one high-speed configuration with a control and a stream interface.
[[nodiscard]] UsbDescriptors descriptors_of(const U3vCameraConfig& config);

}  // namespace todbench::u3v
