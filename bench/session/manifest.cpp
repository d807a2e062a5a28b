#include "bench/session/manifest.h"

#include <algorithm>
#include <array>
#include <map>

#include "bench/text/files.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"

namespace todbench {

namespace {

constexpr std::array<std::string_view, 17> known_files{"comparison.json",  "cost.json",
                                                       "curve.csv",        "fits.json",
                                                       "fits_human.json",  "report.pdf",
                                                       "trials_human.csv", "shown_human.csv",
                                                       "log.txt",          "provenance.json",
                                                       "report.html",      "session.toml",
                                                       "targets.csv",      "targets_simulated.csv",
                                                       "trials.csv",       "trials_simulated.csv",
                                                       "verdict.json"};
constexpr std::array<std::string_view, 2> known_folders{"inputs", "frames"};
constexpr std::string_view schema = "todbench-manifest-1";

struct Entry {
  std::uint64_t bytes = 0;
  std::string sha256;
  bool operator==(const Entry&) const = default;
};
using Entries = std::map<std::string, Entry>;

Result<Entry> entry_of(const std::filesystem::path& file) {
  std::error_code problem;
  const std::uintmax_t bytes = std::filesystem::file_size(file, problem);
  if (problem) return fail(ErrorCode::io, file.string() + ": " + problem.message());
  Result<std::string> sum = sha256_of_file(file);
  if (!sum) return tl::unexpected(sum.error());
  return Entry{bytes, *std::move(sum)};
}

Result<void> write_entries(const std::filesystem::path& folder, const Entries& entries) {
  Json json;
  json["schema"] = schema;
  json["algorithm"] = "SHA-256";
  json["files"] = Json::array();
  for (const auto& [path, entry] : entries) {
    json["files"].push_back(Json{{"path", path}, {"bytes", entry.bytes}, {"sha256", entry.sha256}});
  }
  return write_file_atomically(folder / "manifest.json", to_page(json));
}

Result<Entries> read_entries(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "manifest.json";
  const Result<std::string> text = read_text_file(file);
  if (!text) return tl::unexpected(text.error());
  const Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::invalid_input, file.string() + ": not valid JSON");
  const JsonReader reader(json);
  Entries entries;
  if (reader.at("schema").text() != schema) {
    return fail(ErrorCode::invalid_input, file.string() + ": expected the schema " + std::string(schema));
  }
  for (const JsonReader& item : reader.at("files").elements()) {
    entries[item.at("path").text()] = {item.at("bytes").count(), item.at("sha256").text()};
  }
  if (const Result<void> read = reader.finish(); !read) return fail(file.string(), read.error());
  return entries;
}

}  // namespace

std::vector<std::string> session_files(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  std::error_code problem;
  for (const std::string_view name : known_files) {
    if (std::filesystem::is_regular_file(folder / name, problem)) files.emplace_back(name);
  }
  for (const std::string_view name : known_folders) {
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

Result<void> write_manifest(const std::filesystem::path& folder) {
  Entries entries;
  for (const std::string& file : session_files(folder)) {
    Result<Entry> entry = entry_of(folder / file);
    if (!entry) return tl::unexpected(entry.error());
    entries.emplace(file, *std::move(entry));
  }
  return write_entries(folder, entries);
}

Result<void> refresh_manifest(const std::filesystem::path& folder, const std::vector<std::string>& files) {
  Result<Entries> entries = read_entries(folder);
  if (!entries) return tl::unexpected(entries.error());
  for (const std::string& file : files) {
    Result<Entry> entry = entry_of(folder / file);
    if (!entry) return tl::unexpected(entry.error());
    (*entries)[file] = *std::move(entry);
  }
  return write_entries(folder, *entries);
}

Result<std::vector<std::string>> verify_manifest(const std::filesystem::path& folder) {
  const Result<Entries> entries = read_entries(folder);
  if (!entries) return tl::unexpected(entries.error());
  std::vector<std::string> deviations;
  const std::vector<std::string> present = session_files(folder);
  for (const auto& [path, expected] : *entries) {
    std::error_code problem;
    if (!std::filesystem::is_regular_file(folder / path, problem)) {
      deviations.push_back(path + ": missing");
      continue;
    }
    const Result<Entry> found = entry_of(folder / path);
    if (!found) return tl::unexpected(found.error());
    if (*found != expected) deviations.push_back(path + ": changed since the session was written");
  }
  for (const std::string& path : present) {
    if (!entries->contains(path)) deviations.push_back(path + ": not in the manifest");
  }
  return deviations;
}

}  // namespace todbench
