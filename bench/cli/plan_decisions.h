// SPDX-License-Identifier: GPL-3.0-or-later
// Decision forecasts and the best design as text and JSON, for `todbench plan`.
#pragma once

#include <string>
#include <vector>

#include "bench/cli/console.h"
#include "bench/run/decision_forecast.h"
#include "bench/run/design_search.h"
#include "bench/text/json.h"

namespace todbench {

/// Prints, for each limit, time against the probability of a decision, and the decisions of the planned design.
void print_decisions(const Console& console, const std::vector<DecisionForecast>& forecasts);

/// Key "decide" of `plan --decide --json`.
[[nodiscard]] Json decisions_json(const std::vector<DecisionForecast>& forecasts);

/// Prints the design of least bench time beside the plan as it was.
void print_design(const Console& console, const BestDesign& found);

/// Returns the object of `plan --optimise --json`.
[[nodiscard]] Json best_design_json(const BestDesign& found);

/// Returns the design as the text of a plan file.
[[nodiscard]] std::string design_toml(const BestDesign& found);

}  // namespace todbench
