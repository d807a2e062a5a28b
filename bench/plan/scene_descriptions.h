// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes and targets from their TOML files.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/number_range.h"
#include "acquisition/base/result.h"
#include "bench/plan/resources.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/scene/target_model.h"

namespace todbench {

/// Ranges of values that scenes, targets and sets share.
inline const NumberRange scene_kelvin_range = NumberRange::between(100, 5000);
inline const NumberRange scene_share_range = NumberRange::between(0, 1);

/// Picture as stored in its file.
struct StoredPicture {
  cv::Mat1d values;
  enum class Kind { counts, numbers } kind = Kind::numbers;
};
/// Reads a picture file; the TIFF reader is not part of this library. Errors: `invalid_input` with the path.
using PictureReader = std::function<Result<StoredPicture>(const std::string& path)>;

/// Load a scene or target by name ("craft-01-side") or file. Files that a scene names are relative to its folder.
/// Errors: `invalid_input` with file and line (key unknown, missing or out of range; contradictory scene).
[[nodiscard]] Result<FieldScene> load_scene(std::string_view reference, const PictureReader& read_picture);
[[nodiscard]] Result<TargetModel> load_target(std::string_view reference);

}  // namespace todbench
