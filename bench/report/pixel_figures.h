// Maps of pixels in the section of physical measures, and what the counts of pixels are called.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Maps of the camera (or of the simulated sensor alone) beside those of the twin; nothing where there are none.
[[nodiscard]] std::optional<FigurePairs> pixel_figures(const SessionMeasures& measures, bool camera);

/// "bad_pixels (centre)" as "Bad pixels in zone 'centre'"; empty for a measure that counts no pixels.
[[nodiscard]] std::string pixel_measure_name(std::string_view measure);

}  // namespace todbench
