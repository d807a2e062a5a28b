// The PNG files of measures.json: in the folder pictures/ of a session, referred to by name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/text/json.h"

namespace todbench {

/// Of a session folder.
inline constexpr std::string_view pictures_folder = "pictures";

struct MeasurePicture {
  std::string file;  ///< below the session folder: "pictures/main-temporal_noise.png"
  std::string png;   ///< bytes
};

/// Puts names of files where measures_json() has pictures as base64, and hands the pictures out.
[[nodiscard]] std::vector<MeasurePicture> take_pictures(Json& measures);

/// The other way: where a record names files, reads them from the session folder. A record of an older version has the
/// pictures itself and stays as it is; a picture that is missing leaves the record without it, and with a reason.
/// `invalid_input` for a name that take_pictures() does not make, or a file that is no PNG or cannot be read.
[[nodiscard]] Result<Json> with_pictures(Json measures, const std::filesystem::path& folder);

}  // namespace todbench
