// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of people from a file, beside those of an observer with an eye.
#pragma once

#include <filesystem>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/report/vision_page.h"
#include "bench/studies/measured_eye.h"

namespace todbench {

/// Reads a CSV file of people's figures, a row each, and returns one kind for each `dataset` of the file (one for all
/// rows without this column), with the figure of the eye beside each.
///
/// Contrast sensitivity: `luminance_cd_m2`, `sensitivity` (1 / luminance contrast), `stimulus` (`gabor`, `grating`,
/// `disc`; gabor without this column), `frequency_cpd`, and `sigma_deg` or `area_deg2` (area pi sigma^2 of a Gabor
/// pattern or grating, pi radius^2 of a disc); `d_prime` at threshold, 1.41 without this column.
/// Acuity for Landolt rings: `luminance_cd_m2`, `contrast_percent`, `decimal_acuity` (1 / arcmin of the gap).
///
/// Further columns are ignored. Errors: `io_error`; `invalid_input` with the line for a value that is no number, lies
/// outside its physical range, or belongs to a stimulus without a model, and for a file without one of both sets.
[[nodiscard]] Result<std::vector<VisionKind>> figures_of_people(const std::filesystem::path& file,
                                                                const MeasuredEye& eye);

}  // namespace todbench
