// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of a plan to options of measurement, schedule, fit and comparison.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "bench/plan/plan.h"
#include "tod/comparison/comparison.h"
#include "tod/presentation/target.h"
#include "tod/psychometric/tod_curve.h"
#include "tod/schedule/ramp_schedule.h"

namespace todbench {

/// Side of the comparison.
enum class Side {
  measured,   ///< camera of the plan
  simulated,  ///< simulated sensor of the plan
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(Side side);

/// Returns the options with the seed of the plan. `ifov_mrad`: of the camera, or of the sensor for the simulated side.
/// The answers are binary in every case; chosen_answers() selects other answers.
[[nodiscard]] MeasurementOptions measurement_options(const Plan& plan, const std::vector<TargetPlate>& plates,
                                                     double ifov_mrad);
/// Returns the options for the camera of the plan, with its contrast unit.
[[nodiscard]] MeasurementOptions camera_options(const Plan& plan, const std::vector<TargetPlate>& plates);
/// Returns the options of a schedule with every plate in every mounting at every contrast, and the phases of `side`.
[[nodiscard]] ConstantStimuliOptions stimuli_options(const Plan& plan, const std::vector<TargetPlate>& plates,
                                                     double ifov_mrad, Side side);
/// Returns the ramp of a plan of kind ramp, for the camera.
[[nodiscard]] RampOptions ramp_options(const Plan& plan, const std::vector<TargetPlate>& plates, double ifov_mrad);
/// Returns the plan for the twin of a camera: a ramp becomes a constant schedule, and every contrast settles.
[[nodiscard]] Plan with_settled_contrasts(Plan plan);
/// Adds the contrasts of the acuity limits to the contrasts of the target, if the schedule is a ramp. Returns other
/// plans unchanged.
[[nodiscard]] Plan with_limits_in_ramp(Plan plan);
/// Returns whether the contrast of each presentation is measured from its own frames.
[[nodiscard]] bool has_own_contrasts(const Plan& plan);
/// Returns the schedule of the plan. `ifov_mrad`: as for stimuli_options(). `functions`: psychometric functions of the
/// twin by contrast. The stopping rule of an adaptive schedule uses these functions if they are fitted to the answers.
[[nodiscard]] std::unique_ptr<TrialSchedule> make_schedule(const Plan& plan, const std::vector<TargetPlate>& plates,
                                                           double ifov_mrad, Side side, const RandomStream& stream,
                                                           std::map<double, ProportionTable> functions = {});
/// Returns the options of the fit, from [fit].
[[nodiscard]] FitOptions fit_options(const Plan& plan);
/// Fitted function and the reason for it.
struct ChosenEstimator {
  FitEstimator estimator = FitEstimator::weibull;
  EstimatorReason reason = EstimatorReason::no_twin;
};
/// Chooses the estimator that the plan names. If the plan names no estimator, chooses the function of the simulated
/// twin `sensor`, or a Weibull function if modules follow the sensor. No other code chooses the estimator.
[[nodiscard]] ChosenEstimator chosen_estimator(const Plan& plan, const SensorSpec& sensor);
/// Frames that a graded answer averages if the plan does not state the number.
inline constexpr int frames_of_graded_answers = 4;
/// Smallest number of presentations per contrast for graded answers. The scatter with fewer presentations is unknown.
inline constexpr int least_graded_presentations = 8;
/// Returns the frames per presentation that the plan states for a contrast; 0: not stated, or no such contrast.
[[nodiscard]] int frames_at(const Plan& plan, double delta_t_k);
/// Chooses the kind of answers that the plan names. If the plan does not name the kind, chooses graded answers only
/// when their intervals are validated: function of the twin without a lapse rate, contrasts in kelvin, and a ramp or at
/// least eight presentations at each contrast. Otherwise chooses binary answers. No other code chooses the kind. The
/// number of frames is for `delta_t_k` (empty: first contrast of the plan). If the plan does not state the number of
/// frames, graded answers use frames_of_graded_answers.
[[nodiscard]] AnswersTaken chosen_answers(const Plan& plan, const SensorSpec& sensor,
                                          std::optional<double> delta_t_k = std::nullopt);
/// Returns the options with the equivalence margin of the limits; 10 % if the plan has none.
[[nodiscard]] ComparisonOptions comparison_options(const Plan& plan);
/// Returns the limits of bad pixels: the keys of the plan, or the rule of GB/T 17444-2013 as known from abstracts.
[[nodiscard]] BadPixelRules bad_pixel_rules(const MeasuresPlan& measures);
/// Returns the named accuracy with the tolerance of the plan. Half of the tolerance is the allowed standard error of
/// the direct estimate, except for "draft". "auto": all settings follow from the tolerance.
[[nodiscard]] Result<Accuracy> accuracy_of(const Plan& plan);

}  // namespace todbench
