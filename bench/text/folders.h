// Folders to write into.
#pragma once

#include <filesystem>
#include <memory>
#include <system_error>

#include "acquisition/core/result.h"

namespace todbench {

/// What a refused path is: `invalid_input` where the path itself is wrong (it leads through a file, or is too long),
/// `io` where the disk or its permissions refuse.
[[nodiscard]] ErrorCode code_of_path(const std::error_code& problem);
/// Makes the folder with its parents, where it is not there yet, and makes sure that files can be made in it. Errors:
/// those of code_of_path(), with the path.
[[nodiscard]] Result<void> make_folder(const std::filesystem::path& folder);

/// A folder that one program writes into. Held by the system, so it ends with the program, however that ends.
class FolderClaim;
/// Claims a folder until the last copy of the claim is gone. Nothing is written into the folder. Errors:
/// `invalid_input` while somebody else holds it. On file systems that cannot say, nobody does.
[[nodiscard]] Result<std::shared_ptr<const FolderClaim>> claim_folder(const std::filesystem::path& folder);

}  // namespace todbench
