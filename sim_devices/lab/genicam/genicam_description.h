// SPDX-License-Identifier: GPL-3.0-or-later
// Table of the registers of an emulated camera, and the GenICam description derived from it.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace todbench {

enum class FeatureKind {
  integer,
  enumeration,
  command,
  scaled,      ///< a float: raw value of the register times `per_raw`, plus `offset`
  rate,        ///< a float: 10^6 over the raw value, 0.1 ... 1000 Hz
  ieee_float,  ///< a float in eight bytes; value at power-up: `real`
  /// A float: `formula` of VALUE, stored as ieee_float, and CHOICE, the register of the feature `choice`.
  formula,
  text,  ///< `bytes` characters
  /// A Boolean: bit `bit` of the register, counted from the highest as GenICam does for big-endian registers.
  bit,
  chunk_integer,  ///< in the chunk `chunk_id` after every frame, eight bytes
  chunk_scaled,   ///< the same, four bytes, signed, times `per_raw`
};

enum class FeatureAccess { read_only, read_write, write_only };

/// Limits of `rate`.
inline constexpr double least_rate_hz = 0.1, most_rate_hz = 1000;

/// One feature of a camera and its register, which has four bytes unless `kind` states otherwise.
struct CameraFeature {
  std::string name;
  FeatureKind kind = FeatureKind::integer;
  std::uint32_t address = 0;
  FeatureAccess access = FeatureAccess::read_write;
  std::uint32_t initial = 0;  ///< raw value at power-up; for a command: the value that executes it
  std::vector<std::pair<std::string, std::uint32_t>> entries = {};  ///< of an enumeration
  double per_raw = 1, offset = 0, real = 0;
  std::int64_t least = 0, most = 0;  ///< of an integer; least == most: no bounds
  std::uint32_t bytes = 4;
  unsigned bit = 0;
  std::uint32_t chunk_id = 0;
  bool locked_while_streaming = false;
  std::string text = {};  ///< at power-up
  std::string about = {};
  std::string formula = {}, choice = {};
};

/// True if the feature has its own register. Chunks follow frames, and a bit is part of another register.
[[nodiscard]] bool owns_register(const CameraFeature& feature);
/// Bytes of its register.
[[nodiscard]] std::uint32_t register_bytes(const CameraFeature& feature);

struct CameraDescription {
  std::string vendor, model;  ///< in the description and in discovery
  std::string file_name;      ///< of the description, in the camera's URL register
  std::vector<std::pair<std::string, std::vector<CameraFeature>>> categories;
  std::string name_space = "GEV";        ///< "U3V" on USB
  std::endian order = std::endian::big;  ///< of the registers
};

/// Content of a register at power-up, as in memory.
struct RegisterContent {
  std::uint32_t address = 0;
  std::vector<std::uint8_t> bytes;
};
[[nodiscard]] std::vector<RegisterContent> power_up_contents(const CameraDescription& description);

/// GenICam description in GenApi 1.0. Names of features must be letters, digits and underscores; all texts are escaped.
[[nodiscard]] std::string genicam_xml(const CameraDescription& description);

}  // namespace todbench
