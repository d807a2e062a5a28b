// SPDX-License-Identifier: GPL-3.0-or-later
// Registers of an emulated GigE Vision camera: memory, and rules for writing it.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "sim_devices/lab/genicam/genicam_description.h"
#include "sim_devices/lab/gige/gvcp_message.h"

namespace todbench {

/// Memory with rules for access. All registers of the standard (0 ... 0xAFF and stream channel 0 at 0xD00 ... 0xD2F)
/// can be read, and written if the standard allows writing. The registers of the camera follow the table of its
/// features. Other addresses do not exist. Thread-safe.
class RegisterMap {
 public:
  /// Sets the registers of the features to their power-up values and places `xml` at `xml_address`.
  RegisterMap(CameraDescription description, std::string xml);

  /// Address of the description.
  static constexpr std::uint32_t xml_address = 0x00100000;

  /// Reads whole words for a client. Errors: bad_alignment, invalid_address.
  [[nodiscard]] tl::expected<Bytes, GvcpStatus> read(std::uint32_t address, std::size_t bytes) const;
  /// Writes a word for a client. Errors: bad_alignment, invalid_address, write_protect, busy (locked while streaming).
  [[nodiscard]] GvcpStatus write(std::uint32_t address, std::uint32_t value);
  /// Lock and unlock the registers that reject writes while streaming.
  void lock_transport();
  void unlock_transport();

  /// Restores the power-up values of the registers of features.
  void power_up();

  /// Return and set registers for the camera itself, without rules. Addresses below 64 KiB.
  [[nodiscard]] std::uint32_t get(std::uint32_t address) const;
  void set(std::uint32_t address, std::uint32_t value);
  void set_text(std::uint32_t address, std::string_view text, std::size_t bytes);

 private:
  struct Rule {
    FeatureAccess access = FeatureAccess::read_write;
    bool locked_while_streaming = false;
  };
  [[nodiscard]] bool exists(std::uint32_t address) const;

  CameraDescription description_;
  mutable std::mutex mutex_;
  Bytes memory_;
  std::string xml_;
  std::map<std::uint32_t, Rule> rules_;  ///< by address of the word
  bool locked_ = false;
};

}  // namespace todbench
