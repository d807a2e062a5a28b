// SHA-256 of every file of a session folder, so that a later reader knows that nothing was changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

inline constexpr std::string_view manifest_name = "manifest.json";

/// Files of a session, relative to its folder, sorted: the known ones on top and everything in inputs/, frames/ and
/// pictures/. Foreign files beside them are left out. Without manifest.json itself.
[[nodiscard]] std::vector<std::string> session_files(const std::filesystem::path& folder);
/// A path that session_files() would name: somebody reads such a file.
[[nodiscard]] bool is_session_file(std::string_view path);
/// report.html and report.pdf: made from the other files, read by people and by nothing of the program.
[[nodiscard]] bool is_report_page(std::string_view path);

/// What is in a folder against its manifest. Paths relative to the folder, sorted.
struct ManifestCheck {
  /// Other content than listed. manifest.json itself where it is not what was written: no manifest, entries that its
  /// own digest does not cover, or other bytes than those entries are written with.
  std::vector<std::string> changed;
  std::vector<std::string> missing;  ///< listed and not there; manifest.json itself where there is none
  std::vector<std::string> foreign;  ///< there and not listed, whatever it is; empty without a manifest to list them
  /// The digest of the manifest, which a report prints: SHA-256 of one line "SHA256  PATH" for every file but the
  /// report's pages, in the order of the manifest. Empty without a manifest.
  std::string manifest_sha256;
  [[nodiscard]] bool intact() const { return changed.empty() && missing.empty() && foreign.empty(); }
};

/// Reads every file of the folder. `io` with the path when one cannot be read.
[[nodiscard]] Result<ManifestCheck> check_manifest(const std::filesystem::path& folder);
/// Whether the manifest vouches for this one file as it is; false also where there is no manifest. `io` with the path.
[[nodiscard]] Result<bool> is_listed(const std::filesystem::path& folder, const std::string& path);
/// The digest of the manifest that is there. Errors: as refresh_manifest().
[[nodiscard]] Result<std::string> manifest_digest(const std::filesystem::path& folder);

struct ManifestEntry {
  std::uint64_t bytes = 0;
  std::string sha256;
  bool operator==(const ManifestEntry&) const = default;
};
/// By path. Recorded frames may be many gigabytes: what has read them once hands this on.
using ManifestEntries = std::map<std::string, ManifestEntry>;
/// Of the files that are there. Reads each. `io` with the path.
[[nodiscard]] Result<ManifestEntries> manifest_entries(const std::filesystem::path& folder);
/// The digest of a manifest with these entries.
[[nodiscard]] std::string digest_of(const ManifestEntries& entries);
/// Brings the entries of `files` up to date. `io` with the path.
[[nodiscard]] Result<void> update_entries(const std::filesystem::path& folder, const std::vector<std::string>& files,
                                          ManifestEntries& entries);

/// Writes manifest.json with these entries. `io` with the path.
[[nodiscard]] Result<void> write_manifest(const std::filesystem::path& folder, const ManifestEntries& entries);
/// The same for the files that are there.
[[nodiscard]] Result<void> write_manifest(const std::filesystem::path& folder);
/// Brings the entries of `files` up to date and leaves the others as they are: for a report that was rebuilt. `io`, or
/// `invalid_input` when there is no manifest or not the one that was written.
[[nodiscard]] Result<void> refresh_manifest(const std::filesystem::path& folder, const std::vector<std::string>& files);
/// One sentence for every file of the session that is missing, changed or not listed; none when they are as they were
/// written. `invalid_input` when there is no readable manifest (a run that was cut off writes none).
[[nodiscard]] Result<std::vector<std::string>> verify_manifest(const std::filesystem::path& folder);

}  // namespace todbench
