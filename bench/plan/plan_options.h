// What the plan says, in the terms of the parts that do it.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "bench/plan/plan.h"
#include "tod/comparison/comparison.h"
#include "tod/presentation/target.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Which side of the comparison runs.
enum class Side {
  measured,   ///< the camera of the plan
  simulated,  ///< the simulated sensor of the plan
};
[[nodiscard]] std::string_view to_string(Side side);

/// `ifov_mrad` is that of the camera, or of the sensor for the simulated side. The seed is that of the plan. Answers
/// are right or wrong, whatever the plan says of them (chosen_answers()).
[[nodiscard]] MeasurementOptions measurement_options(const Plan& plan, const std::vector<TargetPlate>& plates,
                                                     double ifov_mrad);
/// Those of the camera of the plan, with the unit that it shows contrasts in.
[[nodiscard]] MeasurementOptions camera_options(const Plan& plan, const std::vector<TargetPlate>& plates);
/// Every plate (by its own name) in every mounting at every contrast; phases as the side has them.
[[nodiscard]] ConstantStimuliOptions stimuli_options(const Plan& plan, const std::vector<TargetPlate>& plates,
                                                     double ifov_mrad, Side side);
/// What is shown, constant or adaptive as the plan says. `ifov_mrad` as for stimuli_options(). `functions`: those of
/// the twin by contrast, with which an adaptive schedule stops where the result is fitted with them.
[[nodiscard]] std::unique_ptr<TrialSchedule> make_schedule(const Plan& plan, const std::vector<TargetPlate>& plates,
                                                           double ifov_mrad, Side side, const RandomStream& stream,
                                                           std::map<double, ProportionTable> functions = {});
[[nodiscard]] FitOptions fit_options(const Plan& plan);
/// With what function the answers of a run are fitted, and why with that one.
struct ChosenEstimator {
  FitEstimator estimator = FitEstimator::weibull;
  EstimatorReason reason = EstimatorReason::no_twin;
};
/// The one place where the estimator of a plan is chosen: the one that it names; where it names none, the function of
/// the simulated twin `sensor`, but a Weibull function where modules stand behind it.
[[nodiscard]] ChosenEstimator chosen_estimator(const Plan& plan, const SensorSpec& sensor);
/// Frames over which graded answers are averaged where a plan does not say.
inline constexpr int frames_of_graded_answers = 4;
/// Of a contrast, below which nobody knows how graded answers scatter.
inline constexpr int least_graded_presentations = 8;
/// Those that the plan says of a contrast; 0: it leaves them open, or does not have the contrast.
[[nodiscard]] int frames_at(const Plan& plan, double delta_t_k);
/// The one place where the answers of a plan are chosen: those that it names; where it names none, graded ones where
/// the model observer judges, the function of the twin is fitted, and their intervals are proven: with a constant
/// schedule of eight presentations or more at each contrast, contrasts in kelvin and no lapse.
/// Frames: at the contrast, without one at the first of the plan; where that leaves them open, four of graded answers.
[[nodiscard]] AnswersTaken chosen_answers(const Plan& plan, const SensorSpec& sensor,
                                          std::optional<double> delta_t_k = std::nullopt);
/// The margin of the limits, or 10 % where none is demanded.
[[nodiscard]] ComparisonOptions comparison_options(const Plan& plan);
/// The named accuracy with the tolerance of the plan; half of the tolerance is for the standard error of the direct
/// estimate, except in a draft. "auto": everything from the tolerance.
[[nodiscard]] Result<Accuracy> accuracy_of(const Plan& plan);

}  // namespace todbench
