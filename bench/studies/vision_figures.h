// SPDX-License-Identifier: GPL-3.0-or-later
// Measured data of human vision from a file, and the corresponding values of the eye model.
#pragma once

#include <filesystem>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/report/vision_page.h"
#include "bench/studies/measured_eye.h"

namespace todbench {

/// Reads measured data of human vision from a CSV file and computes the value of the eye model for each row. Returns
/// one kind for each `dataset`, or a single kind if the file has no such column.
///
/// Columns of contrast sensitivities:
/// - `luminance_cd_m2`, `sensitivity` (1 / luminance contrast), `frequency_cpd`
/// - `sigma_deg` or `area_deg2`. The area is pi sigma^2 of a Gabor pattern or grating, pi radius^2 of a disc.
/// - optional: `stimulus` (`gabor`, `grating` or `disc`; default `gabor`), `d_prime` at threshold (default 1.41)
///
/// Columns of acuities for Landolt rings: `luminance_cd_m2`, `contrast_percent`, `decimal_acuity` (1 / arcmin of the
/// gap).
///
/// Further columns are ignored. Errors: those of read_text_file(); `invalid_input` with the line (a value that is no
/// number or outside its range, a stimulus without a model, neither set of columns).
[[nodiscard]] Result<std::vector<VisionKind>> figures_of_people(const std::filesystem::path& file,
                                                                const MeasuredEye& eye);

}  // namespace todbench
