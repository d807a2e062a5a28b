// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes, targets and target sets from their TOML files.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/resources.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/scene/target_model.h"

namespace todbench {

/// Picture as stored in its file: whole counts or numbers.
struct StoredPicture {
  cv::Mat1d values;
  enum class Kind { counts, numbers } kind = Kind::numbers;
};
/// Reads a picture file; the TIFF reader is not part of this library. Errors: `invalid_input` with the path.
using PictureReader = std::function<Result<StoredPicture>(const std::string& path)>;

/// Loads a scene or target by name ("craft-01-side") or file. Files that a scene names are relative to its folder.
/// Errors: `invalid_input` with file and line (key unknown, missing or out of range; contradictory scene).
[[nodiscard]] Result<FieldScene> load_scene(std::string_view reference, const PictureReader& read_picture);
[[nodiscard]] Result<TargetModel> load_target(std::string_view reference);

/// Targets to be discriminated, from the same aspects in front of the same background.
struct TargetSet {
  std::string name, description;
  std::vector<TargetModel> targets;  ///< at least two
  std::vector<double> azimuths_deg;  ///< aspects, at least one
  double background_k = 300, background_emissivity = 1, surround_k = 300;
};
/// Loads a target set by name ("small-craft") or file. Errors: as load_scene().
[[nodiscard]] Result<TargetSet> load_target_set(std::string_view reference);
/// Returns a scene with one target at one aspect, centred in front of the background of the set.
[[nodiscard]] FieldScene scene_of(const TargetSet& set, std::size_t target, double azimuth_deg);

}  // namespace todbench
