// SPDX-License-Identifier: GPL-3.0-or-later
// Folders for output.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "acquisition/base/result.h"

namespace todbench {

/// Returns the code of a path error: `invalid_input` if the path itself is wrong (it passes through a file, or is too
/// long), `io` for an error of the disk or of permissions.
[[nodiscard]] ErrorCode code_of_path(const std::error_code& problem);
/// Creates the folder with its parents if absent, and checks that files can be created in it. Errors: code_of_path(),
/// with the path.
[[nodiscard]] Result<void> make_folder(const std::filesystem::path& folder);

/// Exclusive claim on a folder. The claim is a lock of the operating system and therefore always ends with the program.
class FolderClaim;
/// Claims a folder until the last copy of the claim is destroyed. Writes no file into the folder. On file systems
/// without locks the claim always succeeds. Errors: `invalid_input` (held by another program).
[[nodiscard]] Result<std::shared_ptr<const FolderClaim>> claim_folder(const std::filesystem::path& folder);

/// Returns the name of a numbered picture, "0001.png".
[[nodiscard]] std::string picture_name(std::size_t number);

}  // namespace todbench
