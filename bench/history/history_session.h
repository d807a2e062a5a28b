// What the history keeps of a session: its unit and its values, read from the folder, which stays the truth.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// Of whom. A lens of its own, or another one, makes another unit.
struct HistoryUnit {
  std::string vendor, model, serial, lens;
  bool operator==(const HistoryUnit&) const = default;
};

/// A value with its uncertainty; there is none without.
struct HistoryValue {
  std::string measure;    ///< "acuity", or a name of measures.json
  std::string condition;  ///< "dT=2K"; empty: none
  std::string unit;       ///< of the value, or of what it is the logarithm of
  std::string scale;      ///< "ln" or "linear"
  double value = 0;
  double u = 0;  ///< standard, without what is common to a series
};

struct HistorySession {
  HistoryUnit unit;
  std::string path, manifest_sha256, started_utc, program, state, firmware;
  std::vector<HistoryValue> values;
};

/// Reads only small files, each of which the manifest has to vouch for. A simulation is a unit of vendor "simulation"
/// without serial number. `invalid_input`: no session, one without manifest, with changed files, without a camera's
/// serial number, or with two. `io` with the path.
[[nodiscard]] Result<HistorySession> read_history_session(const std::filesystem::path& folder);

/// Session folders at or below a folder, sorted. `not_found`, `io` with the path.
[[nodiscard]] Result<std::vector<std::filesystem::path>> session_folders_below(const std::filesystem::path& folder);

/// Days since 1970 of "2026-11-22T10:50:12Z"; nothing for other texts.
[[nodiscard]] std::optional<double> days_of_utc(const std::string& utc);
/// "2026-11-22"
[[nodiscard]] std::string date_of_days(double days);

}  // namespace todbench
