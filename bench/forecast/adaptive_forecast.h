// SPDX-License-Identifier: GPL-3.0-or-later
// Forecast of an adaptive schedule by simulated runs.
#pragma once

#include <vector>

#include "bench/forecast/prediction.h"

namespace todbench {

struct AdaptiveForecast {
  std::vector<ContrastPrediction> contrasts;  ///< in the order of the plan
  std::vector<AdaptiveRun> runs;              ///< simulated runs
  std::vector<std::vector<int>> looks;        ///< measurements of each contrast in each set-up, in the median run
};

/// Replaces the predictions of constant stimuli by those of an adaptive schedule (AdaptiveSchedule). `constant`: the
/// predictions of constant stimuli. Precondition: the plan has a set-up.
///
/// The schedule ends at the first presentation after which the interval of S75 is narrow enough. This interval comes
/// from few set-ups and scatters from run to run, so the number of presentations scatters too. The forecast simulates
/// 64 runs, with the same random numbers at each call. Each run goes through the visits of the schedule (VisitOrder).
/// The standard error of the answers is the expected one times the scatter of its estimate: over set-ups, over
/// presentations (graded answers of few set-ups), or `scatter_of_binary_error`. The error of the measured contrast
/// comes from simulated triangles (simulated_contrast_half_width()).
///
/// `trials` is the mean over the runs. The intervals are those of the run with the median number of presentations. A
/// contrast whose interval becomes narrow enough in at least half of the runs has the requested half-width.
[[nodiscard]] AdaptiveForecast adaptive_forecast(const std::vector<ContrastPrediction>& constant, const Plan& plan,
                                                 const ExperimentInputs& inputs);

}  // namespace todbench
