// SPDX-License-Identifier: GPL-3.0-or-later
// Decision forecasts and the best design as text and JSON, for `todbench plan`.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/cli/console.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/forecast/design_search.h"
#include "bench/text/json.h"
#include "bench/twin/experiment_inputs.h"
#include "sim_devices/prediction/viewing_proposal.h"

namespace todbench {

/// Prints for each limit a table of measuring time against the probability of a decision, and the forecast for the
/// planned design.
void print_decisions(const Console& console, const std::vector<DecisionForecast>& forecasts, TargetKind target);

/// Returns the value of the key "decide" of `plan --decide --json`.
[[nodiscard]] Json decisions_json(const std::vector<DecisionForecast>& forecasts);

/// Prints the design with the least bench time, and the original plan for comparison.
void print_design(const Console& console, const BestDesign& found);

/// Returns the object of `plan --optimise --json`.
[[nodiscard]] Json best_design_json(const BestDesign& found);

/// Returns the proposed zoom and viewing distance for an observer with an eye, at the largest contrast. Empty for other
/// observers, and if there is no threshold at that contrast. Errors: `interrupted`.
[[nodiscard]] Result<std::optional<ViewingProposal>> viewing_of(const std::vector<double>& delta_t_k,
                                                                const ExperimentInputs& inputs, std::stop_token stop);
/// Returns the value of the key "viewing_proposal" of `plan --json` and `doctor --json`.
[[nodiscard]] Json viewing_json(const ViewingProposal& viewing);

/// Returns the design as the text of a plan file.
[[nodiscard]] std::string design_toml(const BestDesign& found);

}  // namespace todbench
