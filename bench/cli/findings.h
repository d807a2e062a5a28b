// Findings of adequacy as text for people.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "bench/cli/console.h"
#include "bench/run/precision_frontier.h"
#include "tod/comparison/comparison.h"

namespace todbench {

/// One line for each finding, behind `about`; nothing where there are none. What makes a number unfit says so.
void print_findings(const Console& console, const std::optional<Adequacy>& adequacy, std::string_view about);

/// Time against half-width as a table, with the number of frames that buys most.
void print_frontier(const Console& console, const std::vector<PrecisionChoice>& choices);

/// The ratios by common phases as a table, with what they do not cancel; nothing where there are none. `measured_once`:
/// has_contrast_measured_once() of a camera.
void print_paired(const Console& console, const Comparison& comparison, bool measured_once);

}  // namespace todbench
