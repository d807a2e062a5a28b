// What is in a test picture, as a file beside it.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/core/result.h"
#include "tod/pattern/test_picture.h"

namespace todbench {

/// "tod", "mrtd", "edge", "ramp", "siemens", "flat", as they are without options; "flat:0.25", of this level.
/// `invalid_input` for another name or level.
[[nodiscard]] Result<PictureKind> picture_kind_named(std::string_view name);
[[nodiscard]] std::string_view name_of(const PictureKind& kind);

/// TOML: of "tod" a plate that load_plate() reads (one pixel is one millimetre, the origin the middle), of the others
/// their parameters. `shown` is what the first line calls the picture.
[[nodiscard]] std::string pattern_truth(const PictureRequest& request, const TestPicture& picture,
                                        std::string_view shown);

}  // namespace todbench
