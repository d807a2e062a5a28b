// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/manifest.h"

#include <algorithm>
#include <array>
#include <map>

#include "acquisition/base/try.h"
#include "bench/session/foreign_files.h"
#include "bench/session/signature.h"
#include "bench/text/files.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"

namespace todbench {

namespace {

constexpr std::array<std::string_view, 26> known_files{"measures.json",    "comparison.json",
                                                       "cost.json",        "curve.csv",
                                                       "fits.json",        "report.csv",
                                                       "fits_human.json",  "report.pdf",
                                                       "trials_human.csv", "shown_human.csv",
                                                       "log.txt",          "provenance.json",
                                                       "report.html",      "session.toml",
                                                       "targets.csv",      "targets_simulated.csv",
                                                       "trials.csv",       "trials_simulated.csv",
                                                       "uncertainty.json", "verdict.json",
                                                       "grey-levels.csv",  "moving-trials.csv",
                                                       "dynamic.json",     "scene-dependence.json",
                                                       "naked_eye.json",   "naked_eye_comparison.json"};
constexpr std::array<std::string_view, 4> known_folders{"inputs", "frames", "people", "pictures"};
constexpr std::string_view schema = "todbench-manifest-1";

constexpr std::array<std::string_view, 3> report_pages{"report.csv", "report.html", "report.pdf"};

/// Manifests of earlier versions have no digest of themselves.
enum class OwnDigest { none, written };

struct Manifest {
  ManifestEntries entries;
  bool as_written = false;  ///< byte for byte as write_manifest() writes the entries
};

Result<ManifestEntry> entry_of(const std::filesystem::path& file) {
  std::error_code problem;
  const std::uintmax_t bytes = std::filesystem::file_size(file, problem);
  if (problem) return fail(ErrorCode::io, file.string() + ": " + problem.message());
  TODBENCH_TRY(std::string sum, sha256_of_file(file));
  return ManifestEntry{bytes, std::move(sum)};
}

/// Returns the digest of all data in the manifest of all files.
std::string digest_of_entries(const ManifestEntries& entries) {
  std::string lines;
  for (const auto& [path, entry] : entries)
    lines += entry.sha256 + "  " + std::to_string(entry.bytes) + "  " + path + "\n";
  return sha256_of(lines);
}

std::string text_of(const ManifestEntries& entries, OwnDigest own) {
  Json json;
  json["schema"] = schema;
  json["algorithm"] = "SHA-256";
  json["files"] = Json::array();
  for (const auto& [path, entry] : entries) {
    json["files"].push_back(Json{{"path", path}, {"bytes", entry.bytes}, {"sha256", entry.sha256}});
  }
  if (own == OwnDigest::written) {
    json["manifest_sha256"] = digest_of(entries);
    json["entries_sha256"] = digest_of_entries(entries);
  }
  return to_page(json);
}

Result<Manifest> read_manifest(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / manifest_name;
  TODBENCH_TRY(const std::string text, read_text_file(file));
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::invalid_input, file.string() + ": not valid JSON");
  const JsonReader reader(json);
  Manifest manifest;
  if (reader.at("schema").text() != schema) {
    return fail(ErrorCode::invalid_input, file.string() + ": expected the schema " + std::string(schema));
  }
  for (const JsonReader& item : reader.at("files").elements()) {
    manifest.entries[item.at("path").text()] = {item.at("bytes").count(), item.at("sha256").text()};
  }
  if (const Result<void> read = reader.finish(); !read) return fail(file.string(), read.error());
  const bool of_an_earlier_version = !json.contains("manifest_sha256") && !json.contains("entries_sha256");
  manifest.as_written = text == text_of(manifest.entries, of_an_earlier_version ? OwnDigest::none : OwnDigest::written);
  return manifest;
}

/// Reads a manifest that may be updated. It must be as written, because a new digest over edited entries would confirm
/// them.
Result<Manifest> read_written_manifest(const std::filesystem::path& folder) {
  Result<Manifest> manifest = read_manifest(folder);
  if (!manifest || manifest->as_written) return manifest;
  return fail(ErrorCode::invalid_input, (folder / manifest_name).string() + ": changed since the session was written");
}

/// Returns true also for a dangling link.
bool has_a_name(const std::filesystem::path& file) {
  std::error_code problem;
  return std::filesystem::exists(std::filesystem::symlink_status(file, problem));
}

/// Returns every path below the folder that is not a folder; links are not followed.
std::vector<std::string> everything_in(const std::filesystem::path& folder) {
  std::vector<std::string> paths;
  std::error_code problem;
  auto entry = std::filesystem::recursive_directory_iterator(folder, problem);
  for (const auto end = std::filesystem::recursive_directory_iterator(); !problem && entry != end;
       entry.increment(problem)) {
    if (!std::filesystem::is_directory(entry->symlink_status(problem)))
      paths.push_back(entry->path().lexically_relative(folder).generic_string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool is_link(const std::filesystem::path& path) {
  std::error_code problem;
  return std::filesystem::is_symlink(std::filesystem::symlink_status(path, problem));
}

/// Whether the file or a folder of its path inside the session is a symbolic link.
bool through_link(const std::filesystem::path& folder, const std::filesystem::path& path) {
  std::filesystem::path at = folder;
  return std::any_of(path.begin(), path.end(),
                     [&at](const std::filesystem::path& part) { return is_link(at /= part); });
}

/// Compares every listed file with its entry.
Result<void> check_entries(const std::filesystem::path& folder, const ManifestEntries& entries, ManifestCheck& check) {
  for (const auto& [path, expected] : entries) {
    std::error_code problem;
    if (!std::filesystem::is_regular_file(folder / path, problem)) {
      check.missing.push_back(path);
      continue;
    }
    if (through_link(folder, path)) check.links.push_back(path);
    TODBENCH_TRY(const ManifestEntry found, entry_of(folder / path));
    if (found != expected) check.changed.push_back(path);
  }
  return {};
}

/// Returns the files that neither the manifest nor a signature lists.
std::vector<std::string> not_listed(const std::filesystem::path& folder, const ManifestEntries& entries) {
  const std::vector<std::string> signing = files_of_signature(folder);
  std::vector<std::string> foreign;
  for (std::string& path : everything_in(folder)) {
    if (path != manifest_name && !entries.contains(path) &&
        std::find(signing.begin(), signing.end(), path) == signing.end())
      foreign.push_back(std::move(path));
  }
  return foreign;
}

}  // namespace

bool is_report_page(std::string_view path) {
  return std::find(report_pages.begin(), report_pages.end(), path) != report_pages.end();
}

bool is_session_file(std::string_view path) {
  if (std::find(known_files.begin(), known_files.end(), path) != known_files.end()) return true;
  return std::any_of(known_folders.begin(), known_folders.end(), [&](std::string_view folder) {
    return path.starts_with(folder) && path.substr(folder.size()).starts_with('/');
  });
}

std::vector<std::string> session_files(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  std::error_code problem;
  for (const std::string_view name : known_files) {
    if (std::filesystem::is_regular_file(folder / name, problem)) files.emplace_back(name);
  }
  for (const std::string_view name : known_folders) {
    if (is_link(folder / name)) continue;
    auto entry = std::filesystem::recursive_directory_iterator(folder / name, problem);
    if (problem) continue;
    for (const auto end = std::filesystem::recursive_directory_iterator(); entry != end; entry.increment(problem)) {
      if (problem) break;
      if (entry->is_regular_file(problem)) files.push_back(entry->path().lexically_relative(folder).generic_string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Result<ManifestEntries> manifest_entries(const std::filesystem::path& folder) {
  ManifestEntries entries;
  for (const std::string& file : session_files(folder)) {
    TODBENCH_TRY(ManifestEntry entry, entry_of(folder / file));
    entries.emplace(file, std::move(entry));
  }
  return entries;
}

/// Digest of lines in the format of sha256sum. Report pages are excluded: they print the digest, and a file cannot
/// contain its own.
std::string digest_of(const ManifestEntries& entries) {
  std::string lines;
  for (const auto& [path, entry] : entries) {
    if (!is_report_page(path)) lines += entry.sha256 + "  " + path + "\n";
  }
  return sha256_of(lines);
}

Result<void> update_entries(const std::filesystem::path& folder, const std::vector<std::string>& files,
                            ManifestEntries& entries) {
  for (const std::string& file : files) {
    TODBENCH_TRY(entries[file], entry_of(folder / file));
  }
  return {};
}

Result<void> write_manifest(const std::filesystem::path& folder, const ManifestEntries& entries) {
  return write_file_atomically(folder / manifest_name, text_of(entries, OwnDigest::written));
}

Result<void> write_manifest(const std::filesystem::path& folder) {
  TODBENCH_TRY(const ManifestEntries entries, manifest_entries(folder));
  return write_manifest(folder, entries);
}

Result<bool> is_listed(const std::filesystem::path& folder, const std::string& path) {
  const Result<Manifest> manifest = read_manifest(folder);
  if (!manifest || !manifest->as_written) return false;
  const auto entry = manifest->entries.find(path);
  if (entry == manifest->entries.end() || through_link(folder, path)) return false;
  TODBENCH_TRY(const ManifestEntry found, entry_of(folder / path));
  return found == entry->second;
}

Result<std::string> manifest_digest(const std::filesystem::path& folder) {
  TODBENCH_TRY(const Manifest manifest, read_written_manifest(folder));
  return digest_of(manifest.entries);
}

Result<void> refresh_manifest(const std::filesystem::path& folder, const std::vector<std::string>& files) {
  TODBENCH_TRY(Manifest manifest, read_written_manifest(folder));
  TODBENCH_TRY_VOID(require_unsigned(folder));
  TODBENCH_TRY_VOID(update_entries(folder, files, manifest.entries));
  return write_manifest(folder, manifest.entries);
}

Result<ManifestCheck> check_manifest(const std::filesystem::path& folder) {
  ManifestCheck check;
  if (!has_a_name(folder / manifest_name)) {
    check.missing.emplace_back(manifest_name);
    return check;
  }
  if (is_link(folder / manifest_name)) check.links.emplace_back(manifest_name);
  const Result<Manifest> manifest = read_manifest(folder);
  if (!manifest || !manifest->as_written) check.changed.emplace_back(manifest_name);
  if (!manifest) return check;
  check.manifest_sha256 = digest_of(manifest->entries);
  TODBENCH_TRY_VOID(check_entries(folder, manifest->entries, check));
  check.foreign = not_listed(folder, manifest->entries);
  std::sort(check.changed.begin(), check.changed.end());
  std::sort(check.links.begin(), check.links.end());
  return check;
}

Result<void> require_no_links(const std::filesystem::path& folder) {
  for (const std::string& path : everything_in(folder)) {
    if (is_link(folder / path)) {
      return fail(ErrorCode::invalid_input, folder.string() + ": the program does not write into this folder because " +
                                                path + " is a symbolic link");
    }
  }
  return {};
}

Result<void> require_no_foreign_file(const std::filesystem::path& folder) {
  TODBENCH_TRY_VOID(require_no_links(folder));
  if (!has_a_name(folder / manifest_name)) return {};
  TODBENCH_TRY(const Manifest manifest, read_manifest(folder));
  const std::vector<std::string> foreign = not_listed(folder, manifest.entries);
  if (foreign.empty()) return {};
  return fail(ErrorCode::invalid_input, folder.string() + ": the program does not write into this folder because " +
                                            foreign.front() + (foreign.size() == 1 ? " does" : " and other files do") +
                                            " not belong to the session. Move " +
                                            (foreign.size() == 1 ? "it" : "them") + " away first");
}

}  // namespace todbench
