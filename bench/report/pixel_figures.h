// SPDX-License-Identifier: GPL-3.0-or-later
// Pixel maps in the section of physical measures, and names of pixel counts.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Returns the maps of the camera (or of the simulated sensor alone) next to those of the twin; empty if there are
/// none.
[[nodiscard]] std::optional<FigurePairs> pixel_figures(const SessionMeasures& measures, bool camera);

/// Returns "Bad pixels in zone 'centre'" for "bad_pixels (centre)"; empty for a measure that counts no pixels.
[[nodiscard]] std::string pixel_measure_name(std::string_view measure);

}  // namespace todbench
