// SPDX-License-Identifier: GPL-3.0-or-later
// Findings of adequacy, and other tables of results, as text for people.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "bench/cli/console.h"
#include "bench/forecast/precision_frontier.h"
#include "tod/comparison/comparison.h"

namespace todbench {

/// Prints one line for each finding, after `about`. If a finding makes a number unfit for a decision, the line states
/// this.
void print_findings(const Console& console, const std::optional<Adequacy>& adequacy, std::string_view about);

/// Prints time against half-width as a table, with the recommended number of frames.
void print_frontier(const Console& console, const std::vector<PrecisionChoice>& choices);

/// Prints the ratios by common phases as a table, with the errors that these ratios do not cancel; no output without
/// ratios. `measured_once`: has_contrast_measured_once() of a camera.
void print_paired(const Console& console, const Comparison& comparison, bool measured_once);

}  // namespace todbench
