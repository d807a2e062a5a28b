// SPDX-License-Identifier: GPL-3.0-or-later
// Loading of scenes and target sets, including the pictures and recordings that their files name.
#pragma once

#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/scene_descriptions.h"
#include "bench/plan/target_sets.h"

namespace todbench {

/// Loads a scene with load_scene(); supports TIFF and .npy pictures.
[[nodiscard]] Result<FieldScene> scene_with_pictures(std::string_view reference);
/// Loads a target set with load_target_set(); supports every recording with temperatures, and masks in TIFF and .npy.
[[nodiscard]] Result<TargetSet> target_set_with_pictures(std::string_view reference);

}  // namespace todbench
