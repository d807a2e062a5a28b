// SPDX-License-Identifier: GPL-3.0-or-later
// PNG files to which measures.json refers. The files are stored in the folder pictures/ of a session.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/text/json.h"

namespace todbench {

/// Folder of the pictures, relative to the session folder.
inline constexpr std::string_view pictures_folder = "pictures";

/// Picture of measures.json.
struct MeasurePicture {
  std::string file;  ///< path relative to the session folder: "pictures/main-temporal_noise.png"
  std::string png;   ///< bytes
};

/// Replaces the base64 pictures in a record of measures_json() by file names and returns the pictures.
[[nodiscard]] std::vector<MeasurePicture> take_pictures(Json& measures);

/// Replaces file names by the pictures in the session folder (inverse of take_pictures()). Records of older versions
/// contain the pictures and stay unchanged. A missing picture is removed from the record and a reason is added. Errors:
/// `invalid_input` (name not made by take_pictures(), file unreadable or not a PNG).
[[nodiscard]] Result<Json> with_pictures(Json measures, const std::filesystem::path& folder);

}  // namespace todbench
