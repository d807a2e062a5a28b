// SPDX-License-Identifier: GPL-3.0-or-later
// Description of a module in a file: its place in the chain, its command and its limits.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/module/picture_stage.h"

namespace todbench {

/// Place of a module in the chain.
enum class ModulePlace {
  picture,   ///< picture to picture, after the sensor
  observer,  ///< patch to scores, in place of the templates of the observer
  sensor,    ///< scene to frame: the sensor itself, in a sensor file only
};
/// Places that are allowed in a plan.
inline constexpr std::array all_module_places{ModulePlace::picture, ModulePlace::observer};
/// Returns the name of the place.
[[nodiscard]] std::string_view to_string(ModulePlace place);

/// [[module]] of plans and sensor files. `module_ranges` states the ranges.
struct ModulePlan {
  ModulePlace place = ModulePlace::picture;
  std::string command;                            ///< command for a shell, run in the folder of the caller
  std::string version;                            ///< command whose first line of output is recorded; empty: none
  std::map<std::string, std::string> parameters;  ///< sent in the header
  int limit_ms = 5000;                            ///< time limit for one output, in ms
  int memory_mib = 0;                             ///< limit of address space; 0: no limit
  bool network = false;                           ///< true: the module keeps the network of the host
  int restart_frames = 0;                         ///< outputs after which a new process is started; 0: never
  int settle_frames = 0;                          ///< frames after which earlier scenes no longer affect the output
  bool operator==(const ModulePlan&) const = default;
};
/// Largest values. The smallest value of limit_ms is 1; the smallest value of the other members is 0.
struct ModuleRanges {
  int limit_ms = 600000, memory_mib = 1 << 20, restart_frames = 1000000000, settle_frames = 10000;
};
inline constexpr ModuleRanges module_ranges{};

/// Property of the sensor that is sent in the header of a module.
struct SensorFact {
  std::string name;
  std::variant<double, std::int64_t, std::uint64_t> value;
};
/// Returns the options of the process. The header states place, parameters and, if given, facts of the sensor.
[[nodiscard]] ModuleStageOptions stage_options(const ModulePlan& plan, std::span<const SensorFact> sensor = {});

/// Returns the error of a module as an error of the run. `internal` stays `internal`. Any other error becomes
/// `integrity`, so that it is not mistaken for the loss of the camera.
[[nodiscard]] Error module_error(const ModulePlan& plan, const Error& error);

/// Facts about a module at the start of a run, for the record.
struct ModuleRecord {
  std::string place, command;
  std::string version;                       ///< first line of output of the version command; empty: none
  std::map<std::string, std::string> files;  ///< files that the command names: SHA-256 by path
  bool operator==(const ModuleRecord&) const = default;
};

}  // namespace todbench
