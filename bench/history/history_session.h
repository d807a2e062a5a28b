// SPDX-License-Identifier: GPL-3.0-or-later
// History record of a session: unit and values, read from the session folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Unit under test. The same camera with a different lens is a different unit.
struct HistoryUnit {
  std::string vendor, model, serial, lens;
  bool operator==(const HistoryUnit&) const = default;
};

/// Value with its uncertainty. Values without an uncertainty are not stored.
struct HistoryValue {
  std::string measure;    ///< "acuity", or a name of measures.json
  std::string condition;  ///< "dT=2K"; empty: none
  std::string unit;       ///< unit of the value; for a logarithm, unit of the quantity itself
  std::string scale;      ///< "ln" or "linear"
  double value = 0;
  double u = 0;  ///< standard uncertainty, without the part common to a series
};

/// Record of a session.
struct HistorySession {
  HistoryUnit unit;
  std::string path, manifest_sha256, started_utc, program, state, firmware;
  std::vector<HistoryValue> values;
  std::string observer{};  ///< observer of the curve; empty: not known
  /// True if the frames come from an earlier session. This session is then not a new check of the unit.
  bool judged_again = false;
  /// Digest of the manifest of the interrupted session whose frames are also in this session.
  std::string resumes_sha256{};
};

/// Returns the condition under which a value is compared. The condition of an acuity contains the observer, unless the
/// observer is hvs-1: "dT=2K observer hvs-2". Acuities by different observers are not compared.
[[nodiscard]] std::string stated_condition(const HistorySession& session, const HistoryValue& value);

/// Reads the record from small files that the manifest confirms. A simulation has the vendor "simulation" and no serial
/// number. Errors: `invalid_input` (not a session, no manifest, changed files, no camera serial number, or two), `io`
/// with the path.
[[nodiscard]] Result<HistorySession> read_history_session(const std::filesystem::path& folder);
/// Compares all files of a session with its manifest, also those that the history does not use. Reads every byte.
/// Error: `invalid_input` with the changed files.
[[nodiscard]] Result<void> verify_history_session(const std::filesystem::path& folder);

/// Returns the session folders at or below a folder, sorted. Errors: `not_found`, `io` with the path.
[[nodiscard]] Result<std::vector<std::filesystem::path>> session_folders_below(const std::filesystem::path& folder);

/// Returns the days since 1970 of "2026-11-22T10:50:12Z"; empty for other texts.
[[nodiscard]] std::optional<double> days_of_utc(const std::string& utc);
/// Returns the date as "2026-11-22".
[[nodiscard]] std::string date_of_days(double days);

}  // namespace todbench
