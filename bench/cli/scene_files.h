// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes from files with their pictures, and folders for pictures.
#pragma once

#include <filesystem>
#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/scene_descriptions.h"

namespace todbench {

/// Calls load_scene() with support for TIFF and .npy pictures.
[[nodiscard]] Result<FieldScene> scene_with_pictures(std::string_view reference);

/// Checks a folder for results: new, empty, or allowed to be overwritten. `invalid_input` in one sentence.
enum class ExistingResults { refused, overwritten };
[[nodiscard]] Result<void> check_result_folder(const std::filesystem::path& folder, ExistingResults existing);
/// The same, and creates it.
[[nodiscard]] Result<void> make_result_folder(const std::filesystem::path& folder, ExistingResults existing);

}  // namespace todbench
