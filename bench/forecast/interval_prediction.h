// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted interval of S75 at one contrast, from the number of presentations in each set-up.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "bench/forecast/graded_precision.h"
#include "bench/forecast/prediction.h"

namespace todbench {

/// Expected information of a triangle of a set-up about S75.
struct PlacedInformation {
  std::size_t set_up = 0;  ///< index in numbered_set_ups()
  std::size_t place = 0;   ///< index of its place in the picture (picture_places.h)
  double information = 0;  ///< of a presentation, in any unit
};

/// Expected information of the answers at one contrast about S75.
struct AnswerForecast {
  ContrastOutlook outlook;
  std::vector<double> information;  ///< information of a presentation in each set-up, plate by plate, in any unit
  GradedDesignFigures all{};        ///< graded_design()
  double binary_se = 0;             ///< standard error of ln S75 from binary answers to the design `all`
  std::vector<PlacedInformation> triangles{};  ///< triangles of all set-ups
};

/// Returns the information of a presentation of each set-up at a contrast, plate by plate, in any unit.
[[nodiscard]] std::vector<double> set_up_information(const Plan& plan, const ExperimentInputs& inputs,
                                                     const ContrastOutlook& outlook);

/// Returns the figures of a design that shows every set-up in each phase of the simulation, with the frames of the
/// plan. `information`: set_up_information() of the plan.
[[nodiscard]] GradedDesignFigures graded_design(const Plan& plan, const ExperimentInputs& inputs,
                                                const ContrastOutlook& outlook, const std::vector<double>& information);

/// Returns the forecast at one contrast of a plan whose frames per presentation are chosen (with_frames()). Empty if no
/// threshold is expected, or if the sizes of the plates do not identify it.
[[nodiscard]] std::optional<AnswerForecast> answer_forecast(const Plan& plan, const ExperimentInputs& inputs,
                                                            double delta_t_k);

/// Sets the interval of a contrast after `shown` presentations of each set-up. Precondition: at least one is shown.
void predict_interval(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                      const AnswerForecast& forecast, std::span<const int> shown);

/// Standard deviation of ln of a run's standard error about its expected value, for binary answers.
inline constexpr double scatter_of_binary_error = 0.07;

}  // namespace todbench
