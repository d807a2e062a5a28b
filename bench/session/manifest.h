// SPDX-License-Identifier: GPL-3.0-or-later
// Manifest: SHA-256 of every file of a session folder, to detect later changes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

inline constexpr std::string_view manifest_name = "manifest.json";

/// Returns the files of a session with paths relative to its folder, sorted: the known files in the folder and all
/// files in inputs/, frames/ and pictures/. Foreign files and manifest.json itself are excluded.
[[nodiscard]] std::vector<std::string> session_files(const std::filesystem::path& folder);
/// Returns whether session_files() can contain the path, i.e. whether a reader may use the file.
[[nodiscard]] bool is_session_file(std::string_view path);
/// Returns whether the path is report.html, report.csv or report.pdf. These pages are made from the other files, and
/// the program does not read them.
[[nodiscard]] bool is_report_page(std::string_view path);

/// Comparison of a folder with its manifest. Paths are relative to the folder, sorted.
struct ManifestCheck {
  /// Files that differ from their entries. Includes manifest.json if the program did not write the manifest in this
  /// form: the manifest is unreadable, its digest does not cover its entries, or its bytes differ from the canonical
  /// form of the entries.
  std::vector<std::string> changed;
  std::vector<std::string> missing;  ///< listed but absent; includes manifest.json if absent
  std::vector<std::string> foreign;  ///< present but not listed, of any type; empty without a manifest
  /// Listed files that are symbolic links or lie in a linked folder, and manifest.json if it is a link. Their content
  /// can change without a change of the session folder.
  std::vector<std::string> links{};
  /// Digest of the manifest, as printed in reports: SHA-256 of the lines "SHA256  PATH" of all files except the report
  /// pages, in the order of the manifest. Empty without a manifest.
  std::string manifest_sha256;
  /// Returns whether the folder equals its manifest.
  [[nodiscard]] bool intact() const { return changed.empty() && missing.empty() && foreign.empty() && links.empty(); }
};

/// Reads every file of the folder. Errors: `io` with the path of an unreadable file.
[[nodiscard]] Result<ManifestCheck> check_manifest(const std::filesystem::path& folder);
/// Returns whether the manifest confirms the current content of this file. False without a manifest, and for a symbolic
/// link. Errors: `io` with the path.
[[nodiscard]] Result<bool> is_listed(const std::filesystem::path& folder, const std::string& path);
/// Returns the digest of the existing manifest. Errors: `io`; `invalid_input` (no manifest, or a manifest that the
/// program did not write in this form).
[[nodiscard]] Result<std::string> manifest_digest(const std::filesystem::path& folder);

/// Entry of one file.
struct ManifestEntry {
  std::uint64_t bytes = 0;
  std::string sha256;
  bool operator==(const ManifestEntry&) const = default;
};
/// Entries by path. Recorded frames may have a size of many gigabytes. Code that has read a file therefore passes its
/// entry on, and the file is read only once.
using ManifestEntries = std::map<std::string, ManifestEntry>;
/// Returns the entries of the existing files; reads each file. Errors: `io` with the path.
[[nodiscard]] Result<ManifestEntries> manifest_entries(const std::filesystem::path& folder);
/// Returns the digest of a manifest with these entries.
[[nodiscard]] std::string digest_of(const ManifestEntries& entries);
/// Updates the entries of `files`. Errors: `io` with the path.
[[nodiscard]] Result<void> update_entries(const std::filesystem::path& folder, const std::vector<std::string>& files,
                                          ManifestEntries& entries);

/// Writes manifest.json with these entries. Errors: `io` with the path.
[[nodiscard]] Result<void> write_manifest(const std::filesystem::path& folder, const ManifestEntries& entries);
/// Writes manifest.json with the entries of the existing files.
[[nodiscard]] Result<void> write_manifest(const std::filesystem::path& folder);
/// Updates the entries of `files` in manifest.json and keeps the other entries, for example after a report is rebuilt.
/// Errors: `io`; `invalid_input` (no manifest, a manifest that the program did not write in this form, or a signed
/// session).
[[nodiscard]] Result<void> refresh_manifest(const std::filesystem::path& folder, const std::vector<std::string>& files);

}  // namespace todbench
