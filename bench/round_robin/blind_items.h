// SPDX-License-Identifier: GPL-3.0-or-later
// Blind recordings of an interlaboratory comparison, and their judgement by an observer of todbench.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/reference_set/reference_case.h"
#include "bench/round_robin/submitted_results.h"

namespace todbench {

/// Options of the comparison.
struct BlindOptions {
  int laboratories = 8;  ///< number of laboratories
  int items = 3;         ///< number of items, which all laboratories measure
  /// Frames per item, half of them for each plate: 20 triangles a frame, and 7.4 MB as TIFF and recording.
  int frames = 24;
  /// Determines cameras, contrasts and frames; keep it secret, because it reveals the true values.
  std::uint64_t seed = 1;
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
};

/// Quantity of the items.
inline constexpr std::string_view blind_quantity = "s75_mrad";

/// Returns the simulated cameras with their contrasts: geometry of the SC2000; noise, blur of the optics and contrast
/// are drawn from the seed.
[[nodiscard]] std::vector<ReferenceCase> blind_cases(const BlindOptions& options);

/// Written comparison.
struct BlindComparison {
  std::vector<ReferenceTruth> truths;  ///< true values as sealed
  std::string sealed_sha256;           ///< SHA-256 of the sealed file, which every protocol states
};
/// Writes into an empty folder: sealed.json with the true values, for the coordinator only, and for each laboratory a
/// folder laboratory-N with items.csv, ITEM.tif, ITEM.todrec, ITEM-frames.csv, ITEM-triangles.csv, plates, observer,
/// protocol.html, results.csv to fill in, and SHA256SUMS. Every laboratory receives different frames of the same
/// cameras. The same seed gives the same bytes. Errors: `io`, `interrupted`.
[[nodiscard]] Result<BlindComparison> write_blind_comparison(const std::filesystem::path& folder,
                                                             const BlindOptions& options, std::stop_token stop);

/// Judges the recordings of one laboratory with an observer that knows the positions of the triangles, and fits a
/// Weibull function to its answers. The standard uncertainty follows from the 95 % interval of the fit. Errors:
/// `invalid_input` (no such folder, damaged files), `not_identifiable` (an item without a threshold or without both
/// limits of its interval), `interrupted`.
[[nodiscard]] Result<std::vector<SubmittedResult>> judged_items(const std::filesystem::path& folder,
                                                                const std::string& laboratory,
                                                                const std::string& observer, std::uint64_t seed,
                                                                std::stop_token stop);
/// Returns results as a CSV file that parse_submitted_results() reads.
[[nodiscard]] std::string submitted_csv(const std::vector<SubmittedResult>& results);

}  // namespace todbench
