// Scenes, targets and sets of targets from their TOML files.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/resources.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/scene/target_model.h"

namespace todbench {

/// A picture as its file holds it: whole counts, or numbers.
struct StoredPicture {
  cv::Mat1d values;
  enum class Kind { counts, numbers } kind = Kind::numbers;
};
/// Reads a picture file; the reader of TIFF files is not part of this library. `invalid_input` with the path.
using PictureReader = std::function<Result<StoredPicture>(const std::string& path)>;

/// By name ("craft-01-side") or file. Files that a scene names are relative to its folder. `invalid_input` with file
/// and line for keys that are unknown, missing or out of range, and for a scene that is impossible as a whole.
[[nodiscard]] Result<FieldScene> load_scene(std::string_view reference, const PictureReader& read_picture);
[[nodiscard]] Result<TargetModel> load_target(std::string_view reference);

/// What is told apart: targets from the same sides before the same background.
struct TargetSet {
  std::string name, description;
  std::vector<TargetModel> targets;  ///< at least two
  std::vector<double> azimuths_deg;  ///< aspects, at least one
  double background_k = 300, background_emissivity = 1, surround_k = 300;
};
/// By name ("small-craft") or file; errors as load_scene().
[[nodiscard]] Result<TargetSet> load_target_set(std::string_view reference);
/// One target from one side before the background of the set, its extent in the middle.
[[nodiscard]] FieldScene scene_of(const TargetSet& set, std::size_t target, double azimuth_deg);

}  // namespace todbench
