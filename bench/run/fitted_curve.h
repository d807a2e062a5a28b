// SPDX-License-Identifier: GPL-3.0-or-later
// From trials to the fitted and examined curve of a camera or of a simulated sensor.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "bench/run/measured_run.h"
#include "bench/run/session_end.h"
#include "bench/twin/background_task.h"
#include "bench/twin/background_twin_functions.h"
#include "bench/twin/camera_surrogate.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/twin_shapes.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/contrast_surface.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Answers of a run in the form in which they are fitted. If the contrast of each presentation was measured separately,
/// `surface` contains the psychometric function as a function of contrast.
struct FittedTrials {
  std::vector<Trial> own{};                  ///< answers at the set contrasts
  std::optional<ContrastSurface> surface{};  ///< empty: contrasts were settled
  std::optional<Error> failed{};

  [[nodiscard]] std::span<const Trial> of(const MeasurementResult& run) const {
    return surface ? std::span<const Trial>(own) : std::span<const Trial>(run.trials);
  }
};

/// Returns the answers of a run as they are fitted.
[[nodiscard]] FittedTrials trials_to_fit(const MeasurementResult& run, const Plan& plan, const ExperimentInputs& inputs,
                                         const std::stop_token& stop);

/// Fits a curve with the functions of its simulated sensor, if the plan requests it and the run is complete. `known`:
/// as in fit_twin_shapes().
[[nodiscard]] TwinShapesOutcome take_shape(TodCurve& curve, std::span<const Trial> trials, bool complete,
                                           const Plan& plan, const ExperimentInputs& inputs,
                                           const std::map<double, double>& shown_delta_t_k, const TodCurve* known,
                                           std::stop_token stop);

/// Sets the curve to the fit over all contrasts of a ramp. Returns the findings of the ramp; adds notes and errors to
/// `said`.
[[nodiscard]] std::vector<AdequacyFinding> take_ramp_of(TodCurve& curve, TwinShapesOutcome& said,
                                                        const MeasurementResult& run, const FittedTrials& fitted,
                                                        const Plan& plan);

/// Tests every point, and adds the findings `of_all`, which concern all points.
void examine_all(TodCurve& curve, const Plan& plan, const std::vector<AdequacyFinding>& of_all);

/// Reports that a complete run is now fitted with the functions of the simulated sensor.
void report_fit(const MeasurementResult& result, const Plan& plan, const ExperimentInputs& inputs,
                const OpenSession& open);

/// Stores the outcome of the fit in the result and the log.
void keep_shape(MeasurementResult& result, const TwinShapesOutcome& outcome, const OpenSession& open);

/// Returns the observed contrast for each set contrast.
[[nodiscard]] std::map<double, double> contrasts_seen(const TodCurve& curve);

/// The fitted curve of a camera.
struct FittedCurve {
  TodCurve curve;
  TwinShapesOutcome said;
  std::optional<TodCurve> by_twin{};   ///< fit with the function of the twin, if `curve` has the surrogate's function
  std::map<double, double> model_u{};  ///< standard u of ln S75 by set contrast, if the surrogate is unconfirmed()

  [[nodiscard]] const TodCurve& functions_of_twin() const { return by_twin ? *by_twin : curve; }
};

/// Starts the fit on its own thread. An effective contrast that differs by more than 2 % from the set contrast needs a
/// separate function of the twin. Computing this function takes about a second. All referenced objects must outlive the
/// task. `functions`: null if the adaptive schedule already computed them (`measured.functions`).
[[nodiscard]] std::unique_ptr<BackgroundTask<FittedCurve>> fit_in_background(
    TodCurve curve, const MeasuredRun& measured, const FittedTrials& to_fit, const Plan& plan,
    const ExperimentInputs& inputs, BackgroundTwinFunctions* functions, const CameraSurrogate& surrogate);

}  // namespace todbench
