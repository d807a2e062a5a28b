// SHA-256 of every file of a session folder, so that a later reader knows that nothing was changed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// Files of a session, relative to its folder, sorted: the known ones on top and everything in inputs/ and frames/.
/// Foreign files beside them are left out. Without manifest.json itself.
[[nodiscard]] std::vector<std::string> session_files(const std::filesystem::path& folder);

/// Writes manifest.json for the files that are there. `io` with the path.
[[nodiscard]] Result<void> write_manifest(const std::filesystem::path& folder);
/// Brings the entries of `files` up to date and leaves the others as they are: for a report that was rebuilt. `io`, or
/// `invalid_input` when there is no readable manifest.
[[nodiscard]] Result<void> refresh_manifest(const std::filesystem::path& folder, const std::vector<std::string>& files);
/// One sentence for every file that is missing, changed or not listed; none when the folder is as it was written.
/// `invalid_input` when there is no readable manifest (a run that was cut off writes none).
[[nodiscard]] Result<std::vector<std::string>> verify_manifest(const std::filesystem::path& folder);

}  // namespace todbench
