// SPDX-License-Identifier: GPL-3.0-or-later
// Check of a session folder in one list.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/session/manifest.h"

namespace todbench {

/// Returns one sentence for each file that is missing, changed or not listed; empty if the session is intact. Errors:
/// `invalid_input` (no readable manifest; a run that was cut off has none).
[[nodiscard]] inline Result<std::vector<std::string>> verify_manifest(const std::filesystem::path& folder) {
  const Result<ManifestCheck> check = check_manifest(folder);
  if (!check) return tl::unexpected(check.error());
  if (check->manifest_sha256.empty()) return fail(ErrorCode::invalid_input, folder.string() + ": no readable manifest");
  std::vector<std::string> deviations;
  for (const std::string& path : check->changed) deviations.push_back(path + ": changed since the session was written");
  for (const std::string& path : check->missing) deviations.push_back(path + ": missing");
  std::sort(deviations.begin(), deviations.end());
  for (const std::string& path : check->foreign) {
    if (is_session_file(path)) deviations.push_back(path + ": not in the manifest");
  }
  return deviations;
}

}  // namespace todbench
