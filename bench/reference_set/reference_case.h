// What the reference set holds: simulated sensors, contrasts, and their thresholds.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// A sensor at a contrast, to be measured from its frames.
struct ReferenceCase {
  std::string name;  ///< "case-1"
  SensorSpec sensor;
  double delta_t_k = 0;  ///< of the triangles against the surround
};

/// The threshold that the case has, by the direct estimate: no trials, no psychometric form.
struct ReferenceTruth {
  std::string name;
  double s75_mrad = 0, standard_error_mrad = 0;
};

/// Name and version of everything below. What is changed gets another one.
inline constexpr std::string_view reference_set_name = "todbench-reference-set-1";
/// How far a result may be off: three standard errors of a threshold from the binary answers to the frames of a case
/// (480 triangles, of which a psychometric fit makes about 3.3 %).
inline constexpr double reference_tolerance_percent = 10;
/// Observer whose threshold it is, and the plates, built in.
inline constexpr std::string_view reference_observer = "hvs-1";
inline constexpr double reference_distance_m = 2;
inline constexpr double reference_background_k = 300;

/// Six cases: the SC2000 at the three contrasts of the EO-VISTA paper, one with a blurred optics at two, one with more
/// noise and a fixed pattern at one.
[[nodiscard]] std::vector<ReferenceCase> reference_cases();
/// Of these cases, in their order; always the same numbers, whatever seed the frames have. `interrupted`.
[[nodiscard]] Result<std::vector<ReferenceTruth>> reference_truths(const std::vector<ReferenceCase>& cases,
                                                                   std::stop_token stop);

}  // namespace todbench
