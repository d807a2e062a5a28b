// Scenes from files with the pictures that they name, and folders for pictures.
#pragma once

#include <filesystem>
#include <string_view>

#include "acquisition/core/result.h"
#include "bench/plan/scene_descriptions.h"

namespace todbench {

/// load_scene() with TIFF and .npy pictures.
[[nodiscard]] Result<FieldScene> scene_with_pictures(std::string_view reference);

/// A folder for results: new, empty, or one that may be overwritten. `invalid_input` in one sentence.
enum class ExistingResults { refused, overwritten };
[[nodiscard]] Result<void> check_result_folder(const std::filesystem::path& folder, ExistingResults existing);
/// The same, and makes it.
[[nodiscard]] Result<void> make_result_folder(const std::filesystem::path& folder, ExistingResults existing);

}  // namespace todbench
