// SPDX-License-Identifier: GPL-3.0-or-later
// Citable reference set: frames of simulated cameras with known thresholds, generated from a seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <vector>

#include "bench/reference_set/reference_case.h"

namespace todbench {

/// Options of the set.
struct ReferenceSetOptions {
  std::uint64_t seed = 1;
  /// Frames per case, half of them for each plate. 24 frames of six cases need 44 MB as TIFF and recording.
  int frames = 24;
  std::vector<ReferenceCase> cases = reference_cases();
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
};

/// Writes plates/ and observers/ of the set into a folder. Errors: `io`.
[[nodiscard]] Result<void> write_plates_and_observer(const std::filesystem::path& folder);
/// Writes CASE.tif, CASE.todrec, CASE-frames.csv and CASE-triangles.csv of one case. The frames follow from the seed of
/// the options and `number`. Errors: `io`, `interrupted`.
[[nodiscard]] Result<void> write_reference_case(const std::filesystem::path& folder, const ReferenceCase& c,
                                                std::uint64_t number, const ReferenceSetOptions& options,
                                                const std::stop_token& stop);

/// Writes the set into an empty folder. Writes for each case: CASE.tif (pages of 16 bits), CASE.todrec (the same frames
/// with their scale), CASE-frames.csv and CASE-triangles.csv. Writes for the set: set.json (truths and all settings),
/// sensors, plates and observer as TOML, README.md and SHA256SUMS. The same seed gives the same bytes. Errors: `io`,
/// `interrupted`.
[[nodiscard]] Result<void> write_reference_set(const std::filesystem::path& folder, const ReferenceSetOptions& options,
                                               std::stop_token stop);

}  // namespace todbench
