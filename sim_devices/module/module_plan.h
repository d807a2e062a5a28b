// A module as a file states it: where in the chain it stands, how it is started, what it may take.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/module/picture_stage.h"

namespace todbench {

/// Where in the chain a module stands.
enum class ModulePlace {
  picture,   ///< picture to picture, behind the sensor
  observer,  ///< patch to scores, in place of the templates of the observer
  sensor,    ///< scene to frame: the sensor itself, in a sensor file only
};
/// Those that a plan knows.
inline constexpr std::array all_module_places{ModulePlace::picture, ModulePlace::observer};
[[nodiscard]] std::string_view to_string(ModulePlace place);

/// [[module]] of plans and sensor files. Ranges are those of `module_ranges`.
struct ModulePlan {
  ModulePlace place = ModulePlace::picture;
  std::string command;                            ///< for a shell, in the folder of the caller
  std::string version;                            ///< a command whose first line of output is kept; empty: none
  std::map<std::string, std::string> parameters;  ///< handed over in the header
  int limit_ms = 5000;                            ///< for an answer
  int memory_mib = 0;                             ///< of address space; 0: no limit
  bool network = false;                           ///< keeps the network of the host
  int restart_frames = 0;                         ///< a new process after so many answers; 0: never
  int settle_frames = 0;                          ///< frames after which it has forgotten what it saw before a change
  bool operator==(const ModulePlan&) const = default;
};
/// Largest values; the least are 1 ms and 0 of the others.
struct ModuleRanges {
  int limit_ms = 600000, memory_mib = 1 << 20, restart_frames = 1000000000, settle_frames = 10000;
};
inline constexpr ModuleRanges module_ranges{};

/// A number that the header says of the sensor.
struct SensorFact {
  std::string name;
  std::variant<double, std::int64_t, std::uint64_t> value;
};
/// How its process is started; the header says place, parameters and, where there are any, facts of the sensor.
[[nodiscard]] ModuleStageOptions stage_options(const ModulePlan& plan, std::span<const SensorFact> sensor = {});

/// What went wrong with a module as an error of the run: it is not the camera that was lost.
[[nodiscard]] Error module_error(const ModulePlan& plan, const Error& error);

/// What is known of a module when a run begins, for its record.
struct ModuleRecord {
  std::string place, command;
  std::string version;                       ///< first line that the version command said; empty: none
  std::map<std::string, std::string> files;  ///< that the command names: SHA-256 by path
  bool operator==(const ModuleRecord&) const = default;
};

}  // namespace todbench
