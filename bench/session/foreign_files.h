// SPDX-License-Identifier: GPL-3.0-or-later
// Detection of files in a session that the program did not write. The functions are defined in manifest.cpp.
#pragma once

#include <filesystem>

#include "acquisition/base/result.h"

namespace todbench {

/// Succeeds if the folder has no symbolic links. Files written to the folder then stay in it. Errors: `invalid_input`
/// with the first link.
[[nodiscard]] Result<void> require_no_links(const std::filesystem::path& folder);
/// Makes the checks of require_no_links(), and also requires that the manifest (if any) or a signature lists every
/// file. Call it before writing to a session. Reads no file contents. Errors: `invalid_input` with the first foreign
/// file.
[[nodiscard]] Result<void> require_no_foreign_file(const std::filesystem::path& folder);

}  // namespace todbench
