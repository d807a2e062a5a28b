// SPDX-License-Identifier: GPL-3.0-or-later
// Additions to curve and session of a run whose contrasts are in grey levels.
#pragma once

#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "bench/plan/plan.h"
#include "bench/run/session_end.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Checks that the camera reports its contrast in the unit of the plan. Errors: `calibration` (counts without a
/// temperature scale), `invalid_input` (no triangle large enough for grey levels).
[[nodiscard]] Result<void> check_contrast_of(const Plan& plan, const ExperimentInputs& inputs, const SourceInfo& info);

/// Summary of the frames of one contrast.
struct GreySummary {
  double set_delta_t_k = 0;
  int frames = 0;
  double levels = 0;  ///< mean contrast in grey levels
  double levels_per_k = 0, lowest_per_k = 0, highest_per_k = 0;
  /// Root mean square over the frames. The uncertainty does not decrease with the number of frames, because all frames
  /// share fixed pattern and rounding.
  double relative_uncertainty = 0;
  double noise_steps = 0;  ///< noise in steps of the grey levels: smallest value of all frames
};
/// Returns the summary of the frames of one contrast.
[[nodiscard]] GreySummary grey_summary(const std::vector<GreyFrame>& frames, double set_delta_t_k);
/// Returns "+16.900 K: 201.3 grey levels, 11.9 a kelvin (11.8 to 12.0 in 24 frames), known to 0.8 %; ..."
[[nodiscard]] std::string sentence(const GreySummary& summary);

/// Writes grey-levels.csv of the session and a note for every contrast. Adds the uncertainty of the grey levels to the
/// contrast uncertainty of the points, and stores the noise in steps. No effect if contrasts are in kelvin. Errors:
/// `io`.
[[nodiscard]] Result<void> keep_grey_levels(TodCurve& curve, MeasurementResult& result, const OpenSession& open);

}  // namespace todbench
