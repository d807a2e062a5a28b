// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of curves with the functions of their simulated sensor.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/twin/experiment_inputs.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Returns the options of the direct estimate (without trials) at the contrasts of a curve. `shown_delta_t_k`: contrast
/// that the scene shows for a set contrast, if different.
[[nodiscard]] DirectEstimateOptions direct_options(const TodCurve& curve, const ExperimentInputs& inputs,
                                                   const std::map<double, double>& shown_delta_t_k, std::uint64_t seed,
                                                   std::stop_token stop);

/// Converts the function of a sensor with this instantaneous field of view to the form used by fits.
[[nodiscard]] ProportionTable table_of(const ProportionCurve& curve, double ifov_mrad);

/// Draws per size of the functions: maximum (unless the accuracy needs more) and minimum.
inline constexpr int twin_shape_draws = 4000, least_twin_shape_draws = 1000;
/// Returns the draws for which the error of a function is a quarter of the error of the answers, `se_ln_threshold`. The
/// error of the function then widens an interval by 3 %. Empty `se_ln_threshold`: unknown.
[[nodiscard]] int draws_of_twin_shape(std::optional<double> se_ln_threshold, const Accuracy& accuracy);

/// Computes functions of the simulated sensor at the set contrasts of a plan, to fit answers while they arrive. The
/// number of draws follows the error of the answers (draws_of_twin_shape()). Contrasts without a function are left out;
/// the map is empty if the plan has a Weibull function. Errors: `interrupted`.
[[nodiscard]] Result<std::map<double, ProportionTable>> twin_tables(const Plan& plan, const ExperimentInputs& inputs,
                                                                    std::optional<double> se_ln_threshold,
                                                                    std::stop_token stop);

/// Computes the functions of an adaptive schedule's stopping rule, with the draws for its half-width; empty for a
/// constant schedule.
[[nodiscard]] Result<std::map<double, ProportionTable>> stopping_tables(const Plan& plan,
                                                                        const ExperimentInputs& inputs,
                                                                        std::stop_token stop);

/// Refits the points of a curve with the functions at their set contrasts. Points without a function keep their fit;
/// graded points are refitted as binary answers (fit_right_and_wrong()).
void fit_with_tables(TodCurve& curve, std::span<const Trial> trials, const std::map<double, ProportionTable>& tables,
                     const FitOptions& fit);

/// Outcome with one note for each contrast that keeps its Weibull function.
struct TwinShapesOutcome {
  std::vector<std::string> notes;
  std::optional<Error> ended_by;  ///< `interrupted`
};

/// Refits every point of a curve with the function of the simulated sensor at its contrast (fit_twin_shape()), from the
/// trials of the curve. The interval includes the error of the function: 0.15 to 0.3 % of the threshold for 4000 draws
/// per size. `known`: a curve fitted with functions of the same sensor for the same scenes; functions that it contains
/// are reused.
[[nodiscard]] TwinShapesOutcome fit_twin_shapes(TodCurve& curve, std::span<const Trial> trials,
                                                const ExperimentInputs& inputs, const FitOptions& fit,
                                                const DirectEstimateOptions& options, const TodCurve* known = nullptr);

/// Refits graded points without a function of the twin from the binary answers of the same trials. The reason is that
/// the error of a Weibull function exceeds the interval of graded answers. TodPoint::answers is then binary.
void fit_right_and_wrong(TodCurve& curve, std::span<const Trial> trials, const FitOptions& fit);

/// Compares the directions of the triangles at the contrasts that were fitted with the function of the twin.
void compare_orientations(TodCurve& curve, std::span<const Trial> trials);

}  // namespace todbench
