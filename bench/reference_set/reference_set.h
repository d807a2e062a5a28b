// A reference set that others can cite: frames of simulated cameras with known thresholds, from a seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <vector>

#include "bench/reference_set/reference_case.h"

namespace todbench {

struct ReferenceSetOptions {
  std::uint64_t seed = 1;
  /// Frames of a case, half of each plate: 24 of six cases as TIFF and as recording are 44 MB.
  int frames = 24;
  std::vector<ReferenceCase> cases = reference_cases();
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
};

/// Writes the set into an empty folder: for each case CASE.tif (pages of 16 bits), CASE.todrec (the same frames with
/// their scale), CASE-frames.csv and CASE-triangles.csv; beside them set.json (truths and everything that made them),
/// sensors, plates and observer as TOML, README.md and SHA256SUMS. The same seed gives the same bytes. `io`,
/// `interrupted`.
[[nodiscard]] Result<void> write_reference_set(const std::filesystem::path& folder, const ReferenceSetOptions& options,
                                               std::stop_token stop);

}  // namespace todbench
