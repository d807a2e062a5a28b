// The registers of an emulated camera as a table, and the GenICam description that follows from it.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace todbench {

enum class FeatureKind {
  integer,
  enumeration,
  command,
  scaled,      ///< a float: raw value of the register times `per_raw`
  ieee_float,  ///< a float in four bytes
  text,        ///< `bytes` characters
  bit,         ///< a Boolean: bit `bit` of the register, counted from the highest as GenICam does for big-endian ones
  chunk_integer,  ///< in the chunk `chunk_id` behind every frame, eight bytes
  chunk_scaled,   ///< the same, four bytes, signed, times `per_raw`
};

enum class FeatureAccess { read_only, read_write, write_only };

/// One feature of a camera and the register behind it. Registers are big-endian and have four bytes where `kind` does
/// not say otherwise.
struct CameraFeature {
  std::string name;
  FeatureKind kind = FeatureKind::integer;
  std::uint32_t address = 0;
  FeatureAccess access = FeatureAccess::read_write;
  std::uint32_t initial = 0;  ///< raw value at power-up; of a command: the value that executes it
  std::vector<std::pair<std::string, std::uint32_t>> entries = {};  ///< of an enumeration
  double per_raw = 1;
  std::int64_t least = 0, most = 0, step = 1;  ///< of an integer; least == most: no bounds
  std::uint32_t bytes = 4;
  unsigned bit = 0;
  std::uint32_t chunk_id = 0;
  bool locked_while_streaming = false;
  std::string text = {};  ///< at power-up
  std::string about = {};
};

struct CameraDescription {
  std::string vendor, model;  ///< as the description and discovery state them
  std::string file_name;      ///< of the description, as the camera's URL register states it
  std::vector<std::pair<std::string, std::vector<CameraFeature>>> categories;
};

/// GenApi 1.0 text. Names of features must be letters, digits and underscores; all texts are escaped.
[[nodiscard]] std::string genicam_xml(const CameraDescription& description);

}  // namespace todbench
