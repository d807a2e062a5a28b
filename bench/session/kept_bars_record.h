// SPDX-License-Identifier: GPL-3.0-or-later
// Windows of bars and spots that a session keeps for people: pictures/mrtd-bars.json and pictures/mrtd-bars.f32.
#pragma once

#include <filesystem>
#include <optional>

#include "acquisition/base/result.h"
#include "tod/camera_measures/kept_bars.h"

namespace todbench {

/// Returns the path of mrtd-bars.f32 in a session.
[[nodiscard]] std::filesystem::path kept_bars_file(const std::filesystem::path& session);
/// Writes the places and pictures to mrtd-bars.json. Writes their samples to mrtd-bars.f32 (32-bit floating point,
/// little-endian) in the same order: for each picture both windows, row by row. Errors: `io` with the path.
[[nodiscard]] Result<void> write_kept_bars(const std::filesystem::path& session, const KeptBars& kept);
/// Reads the kept bars of a session that open_session() accepted; empty if the session keeps none. Errors: `io`;
/// `invalid_input` with the file (missing key, wrong length, a sample or contrast that is not finite).
[[nodiscard]] Result<std::optional<KeptBars>> read_kept_bars(const std::filesystem::path& session);

}  // namespace todbench
