// SPDX-License-Identifier: GPL-3.0-or-later
// Result of the last self-test on this computer, which later sessions record in their provenance.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "acquisition/base/result.h"

namespace todbench {

class JsonFields;

/// Result of a self-test (bench/selftest/selftest.h), with the program and the computer that it tested.
struct SelftestRecord {
  std::string utc;
  int passed = 0, failed = 0;
  std::string cases_sha256;  ///< SHA-256 of all cases with their values
  std::string program_version, git_commit, compiler, host;
  bool operator==(const SelftestRecord&) const = default;
};
/// Describes the fields of the record.
void selftest_fields(JsonFields& json, SelftestRecord& record);

/// Returns $XDG_STATE_HOME/todbench/selftest.json; without that variable, the same in ~/.local/state.
[[nodiscard]] std::filesystem::path selftest_file();
/// Completes the record with this program, computer and time, and writes it. Errors: `io`.
[[nodiscard]] Result<void> keep_selftest(const std::filesystem::path& file, SelftestRecord record);
/// Returns the record if it was made by this program on this computer. Empty otherwise, or if there is no readable
/// record.
[[nodiscard]] std::optional<SelftestRecord> kept_selftest(const std::filesystem::path& file);

/// Returns "112 of 112 cases on 2026-01-31T12:34:56Z; SHA-256 ...".
[[nodiscard]] std::string in_words(const SelftestRecord& record);

}  // namespace todbench
