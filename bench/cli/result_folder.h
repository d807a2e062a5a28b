// SPDX-License-Identifier: GPL-3.0-or-later
// Folders for results.
#pragma once

#include <filesystem>

#include "acquisition/base/result.h"

namespace todbench {

/// Checks a folder for results: new, empty, or allowed to be overwritten. `invalid_input` in one sentence.
enum class ExistingResults { refused, overwritten };
[[nodiscard]] Result<void> check_result_folder(const std::filesystem::path& folder, ExistingResults existing);
/// The same, and creates it.
[[nodiscard]] Result<void> make_result_folder(const std::filesystem::path& folder, ExistingResults existing);

}  // namespace todbench
