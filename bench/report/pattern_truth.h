// SPDX-License-Identifier: GPL-3.0-or-later
// Content of a test picture, as a file that accompanies the picture.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "tod/pattern/test_picture.h"

namespace todbench {

/// Parses "tod", "mrtd", "edge", "ramp", "siemens", "flat" with default options, or "flat:0.25" with a level. Errors:
/// `invalid_input` (a different name or level).
[[nodiscard]] Result<PictureKind> picture_kind_named(std::string_view name);
/// Returns the name of a kind of picture.
[[nodiscard]] std::string_view name_of(const PictureKind& kind);

/// Returns TOML: for "tod" a plate for load_plate() (one pixel is one millimetre, origin at the centre), for others
/// their parameters. `shown` is the name of the picture in the first line.
[[nodiscard]] std::string pattern_truth(const PictureRequest& request, const TestPicture& picture,
                                        std::string_view shown);

}  // namespace todbench
