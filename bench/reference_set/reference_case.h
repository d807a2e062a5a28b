// SPDX-License-Identifier: GPL-3.0-or-later
// Content of the reference set: simulated sensors, contrasts and their thresholds.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// One case: a simulated sensor and a contrast. Participants measure its threshold from its frames.
struct ReferenceCase {
  std::string name;  ///< "case-1"
  SensorSpec sensor;
  double delta_t_k = 0;  ///< contrast of the triangles against the surround
};

/// True threshold of a case from the direct estimate, which uses neither trials nor a psychometric function.
struct ReferenceTruth {
  std::string name;
  double s75_mrad = 0, standard_error_mrad = 0;
};

/// Name and version of the definitions below. A changed definition gets a new version.
inline constexpr std::string_view reference_set_name = "todbench-reference-set-1";
/// Tolerance of a result: three standard errors of a threshold from binary answers to the frames of a case (480
/// triangles give a standard error of about 3.3 %).
inline constexpr double reference_tolerance_percent = 10;
/// Built-in observer that defines the thresholds, and geometry of the cases.
inline constexpr std::string_view reference_observer = "hvs-1";
inline constexpr double reference_distance_m = 2;
inline constexpr double reference_background_k = 300;

/// Returns six cases: the SC2000 at the three contrasts of the EO-VISTA paper, a sensor with blurred optics at two
/// contrasts, and a sensor with more noise and a fixed pattern at one contrast.
[[nodiscard]] std::vector<ReferenceCase> reference_cases();
/// Returns the truths of these cases in their order; independent of the seed of the frames. Errors: `interrupted`.
[[nodiscard]] Result<std::vector<ReferenceTruth>> reference_truths(const std::vector<ReferenceCase>& cases,
                                                                   std::stop_token stop);

}  // namespace todbench
