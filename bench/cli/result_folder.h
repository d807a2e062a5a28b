// SPDX-License-Identifier: GPL-3.0-or-later
// Folders for results.
#pragma once

#include <filesystem>

#include "acquisition/base/result.h"

namespace todbench {

/// Treatment of a folder with results.
enum class ExistingResults { refused, overwritten };
/// Checks that a folder for results is new, empty, or allowed to be overwritten. Errors: `invalid_input`.
[[nodiscard]] Result<void> check_result_folder(const std::filesystem::path& folder, ExistingResults existing);
/// Makes the same checks and creates the folder.
[[nodiscard]] Result<void> make_result_folder(const std::filesystem::path& folder, ExistingResults existing);

}  // namespace todbench
