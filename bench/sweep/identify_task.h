// SPDX-License-Identifier: GPL-3.0-or-later
// Tasks of a sweep in which an observer identifies the targets of a set, with parameters for set, air and ranges.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/loaded_plan.h"
#include "bench/studies/identification_study.h"
#include "bench/sweep/sweep_file.h"
#include "bench/text/json.h"

namespace todbench {

/// Returns whether a key belongs to the identification: set, ranges_m, atmosphere, haze, extinction_per_km,
/// cn2_m_minus_2_3, decisions, cues, m75. All other keys belong to the plan and the sensor.
[[nodiscard]] bool is_identification_key(std::string_view key);

/// Returns the study of a task with the sensor, observer, display, accuracy and motion of a plan. If two parameters
/// have the same key, the later parameter is used. Errors: `invalid_input` with the key; those of the loaders.
[[nodiscard]] Result<IdentificationStudyTask> identification_task(const std::vector<SweepParameter>& parameters,
                                                                  const std::filesystem::path& folder,
                                                                  const LoadedPlan& plan, std::stop_token stop);

/// Returns a text that changes if a file of a set or of an air path in these parameters changes.
[[nodiscard]] Result<std::string> identification_fingerprint(const std::vector<SweepParameter>& parameters,
                                                             const std::filesystem::path& folder);

/// Returns {"points": [one]}: R75, M75 and V50 with intervals, size, dT_RSS and the predicted range.
[[nodiscard]] Result<Json> identified(const IdentificationStudyTask& task);

}  // namespace todbench
