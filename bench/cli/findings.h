// SPDX-License-Identifier: GPL-3.0-or-later
// Output of adequacy findings and of other results as text for people.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "bench/cli/console.h"
#include "bench/forecast/precision_frontier.h"
#include "tod/comparison/comparison.h"

namespace todbench {

/// Prints one line for each finding: "not fit for a decision: " or "finding: ", then `about` (the result to which the
/// finding applies), then the sentence of the finding.
void print_findings(const Console& console, const std::optional<Adequacy>& adequacy, std::string_view about);

/// Prints a table of measuring time and half-width of S75 for each choice. Marks the planned and recommended choices.
void print_frontier(const Console& console, const std::vector<PrecisionChoice>& choices);

/// Prints a table of the paired ratios (tod/comparison/paired_ratio.h), and a sentence about errors that do not cancel
/// in these ratios. No output without paired ratios. `measured_once`: has_contrast_measured_once() of a camera's curve.
void print_paired(const Console& console, const Comparison& comparison, bool measured_once);

}  // namespace todbench
