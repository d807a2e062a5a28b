// SPDX-License-Identifier: GPL-3.0-or-later
// Text files of a reference set.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/reference_set/reference_case.h"
#include "bench/reference_set/reference_set.h"

namespace todbench {

/// Returns the text of a sensor description with every key.
[[nodiscard]] std::string sensor_description(const SensorSpec& sensor);
/// Returns set.json.
[[nodiscard]] std::string set_description(const ReferenceSetOptions& options,
                                          const std::vector<ReferenceTruth>& truths);
/// Returns README.md: purpose, columns, scoring, licence.
[[nodiscard]] std::string set_readme(const ReferenceSetOptions& options);
/// Returns the lines "SHA256  PATH" of every file below the folder except SHA256SUMS, sorted. Errors: `io`.
[[nodiscard]] Result<std::string> set_sums(const std::filesystem::path& folder);
/// Reads the truths of a written set. Errors: `invalid_input` (no such folder, no set of this version, or a file that
/// differs from SHA256SUMS).
[[nodiscard]] Result<std::vector<ReferenceTruth>> read_truths(const std::filesystem::path& folder);

}  // namespace todbench
