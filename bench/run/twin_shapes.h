// Curves fitted with the functions of their simulated sensor.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/run/experiment_inputs.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// What the simulated sensor is asked without trials, at the contrasts of a curve. `shown_delta_t_k`: what the scene
/// shows of a set contrast, where it is not the same.
[[nodiscard]] DirectEstimateOptions direct_options(const TodCurve& curve, const ExperimentInputs& inputs,
                                                   const std::map<double, double>& shown_delta_t_k, std::uint64_t seed,
                                                   std::stop_token stop);

/// The function of a sensor with this instantaneous field of view as it is fitted with.
[[nodiscard]] ProportionTable table_of(const ProportionCurve& curve, double ifov_mrad);

/// Draws per size of the functions: the most, or those of the accuracy where they are more, and the least.
inline constexpr int twin_shape_draws = 4000, least_twin_shape_draws = 1000;
/// As many as make the error of a function a quarter of that of the answers, `se_ln_threshold`, by which it lengthens
/// an interval by 3 %; nothing: not known.
[[nodiscard]] int draws_of_twin_shape(std::optional<double> se_ln_threshold, const Accuracy& accuracy);

/// Functions of the simulated sensor at the set contrasts of a plan, for fits of answers while they come in; of as many
/// draws as answers with this error need (draws_of_twin_shape()). Contrasts without a function are left out; none where
/// the plan has a Weibull function. Errors: `interrupted`.
[[nodiscard]] Result<std::map<double, ProportionTable>> twin_tables(const Plan& plan, const ExperimentInputs& inputs,
                                                                    std::optional<double> se_ln_threshold,
                                                                    std::stop_token stop);

/// Those that an adaptive schedule stops by, of as many draws as its half-width needs; none for a constant one.
[[nodiscard]] Result<std::map<double, ProportionTable>> stopping_tables(const Plan& plan,
                                                                        const ExperimentInputs& inputs,
                                                                        std::stop_token stop);

/// Fits the points of a curve of these trials anew with the functions at their set contrasts; those without one keep
/// their fit, but graded ones only as right and wrong answers (fit_right_and_wrong()).
void fit_with_tables(TodCurve& curve, std::span<const Trial> trials, const std::map<double, ProportionTable>& tables,
                     const FitOptions& fit);

/// What became of it, a sentence for each contrast that keeps its Weibull function.
struct TwinShapesOutcome {
  std::vector<std::string> notes;
  std::optional<Error> ended_by;  ///< `interrupted`
};

/// Fits every point of a curve anew with the function of the simulated sensor at its contrast (fit_twin_shape()), from
/// the trials that it was made of. The interval holds the error of the function: of 4000 draws per size 0.15 to 0.3 %
/// of the threshold. `known`: a curve that was fitted with the functions of the same sensor
/// for the same scenes; they are taken from it where it has them.
[[nodiscard]] TwinShapesOutcome fit_twin_shapes(TodCurve& curve, std::span<const Trial> trials,
                                                const ExperimentInputs& inputs, const FitOptions& fit,
                                                const DirectEstimateOptions& options, const TodCurve* known = nullptr);

/// The points of graded answers that have no function of the twin are fitted anew from the right and wrong answers of
/// the same trials: a Weibull function is off by more than the interval of graded ones. TodPoint::answers says so.
void fit_right_and_wrong(TodCurve& curve, std::span<const Trial> trials, const FitOptions& fit);

}  // namespace todbench
