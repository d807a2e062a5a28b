// SPDX-License-Identifier: GPL-3.0-or-later
// Registers of an emulated camera as a table, and the GenICam description derived from the table.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace todbench {

/// Kind of a feature.
enum class FeatureKind {
  integer,
  enumeration,
  command,
  scaled,      ///< a float: raw value of the register times `per_raw`, plus `offset`
  rate,        ///< a float: 10^6 / raw value, in Hz, 0.1 ... 1000
  ieee_float,  ///< a float in eight bytes; value at power-up: `real`
  /// A float, computed by `formula` from two variables: VALUE, stored as ieee_float, and CHOICE, the register of the
  /// feature `choice`.
  formula,
  text,  ///< `bytes` characters
  /// A Boolean: bit number `bit` of the register, counted from the highest bit, as in big-endian GenICam registers.
  bit,
  chunk_integer,  ///< an integer of eight bytes in the chunk `chunk_id` after every frame
  chunk_scaled,   ///< a signed number of four bytes in a chunk, times `per_raw`
};

/// Access of a client.
enum class FeatureAccess { read_only, read_write, write_only };

/// Limits of the kind `rate`, in Hz.
inline constexpr double least_rate_hz = 0.1, most_rate_hz = 1000;

/// One feature of a camera and its register, which has four bytes unless `kind` states otherwise.
struct CameraFeature {
  std::string name;
  FeatureKind kind = FeatureKind::integer;
  std::uint32_t address = 0;
  FeatureAccess access = FeatureAccess::read_write;
  std::uint32_t initial = 0;  ///< raw value at power-up; for a command: the value that executes it
  std::vector<std::pair<std::string, std::uint32_t>> entries = {};  ///< entries of an enumeration
  double per_raw = 1, offset = 0, real = 0;
  std::int64_t least = 0, most = 0;  ///< limits of an integer; least == most: no limits
  std::uint32_t bytes = 4;
  unsigned bit = 0;
  std::uint32_t chunk_id = 0;
  bool locked_while_streaming = false;
  std::string text = {};  ///< text at power-up
  std::string about = {};
  std::string formula = {}, choice = {};
};

/// Returns whether the feature has its own register: false for a chunk, and for a bit, which is part of a register.
[[nodiscard]] bool owns_register(const CameraFeature& feature);
/// Returns the size of the feature's register in bytes.
[[nodiscard]] std::uint32_t register_bytes(const CameraFeature& feature);

/// Description of a camera.
struct CameraDescription {
  std::string vendor, model;  ///< names in the description and in discovery
  std::string file_name;      ///< file name of the description in the URL register of the camera
  std::vector<std::pair<std::string, std::vector<CameraFeature>>> categories;
  std::string name_space = "GEV";        ///< "U3V" on USB
  std::endian order = std::endian::big;  ///< byte order of the registers
};

/// Content of a register at power-up, as in memory.
struct RegisterContent {
  std::uint32_t address = 0;
  std::vector<std::uint8_t> bytes;
};
/// Returns the content of all registers at power-up.
[[nodiscard]] std::vector<RegisterContent> power_up_contents(const CameraDescription& description);

/// Returns the GenICam description in GenApi 1.0. Names of features must be letters, digits and underscores; all texts
/// are escaped.
[[nodiscard]] std::string genicam_xml(const CameraDescription& description);

}  // namespace todbench
