// What a run whose contrasts are in grey levels adds to its curve and its session.
#pragma once

#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "bench/plan/plan.h"
#include "bench/run/experiment_inputs.h"
#include "bench/run/session_frame.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// That the camera shows its contrast in the unit of the plan. Errors: `calibration` (counts without a temperature
/// scale), `invalid_input` (no triangles that are large enough for grey levels).
[[nodiscard]] Result<void> check_contrast_of(const Plan& plan, const ExperimentInputs& inputs, const SourceInfo& info);

/// The frames of one contrast together.
struct GreySummary {
  double set_delta_t_k = 0;
  int frames = 0;
  double levels = 0;  ///< mean contrast
  double levels_per_k = 0, lowest_per_k = 0, highest_per_k = 0;
  /// Root mean square over the frames: frames share fixed pattern and rounding, so it does not fall with their number.
  double relative_uncertainty = 0;
  double noise_steps = 0;  ///< the least of any frame
};
[[nodiscard]] GreySummary grey_summary(const std::vector<GreyFrame>& frames, double set_delta_t_k);
/// "+16.900 K: 201.3 grey levels, 11.9 a kelvin (11.8 to 12.0 in 24 frames), known to 0.8 %; ..."
[[nodiscard]] std::string sentence(const GreySummary& summary);

/// grey-levels.csv of the session, a note for every contrast, its uncertainty in that of the points' contrast, its
/// noise in steps in theirs. Nothing where contrasts are in kelvin. Errors: `io`.
[[nodiscard]] Result<void> keep_grey_levels(TodCurve& curve, MeasurementResult& result, const SessionFrame& frame);

}  // namespace todbench
