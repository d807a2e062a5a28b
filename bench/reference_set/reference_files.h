// The files of a reference set that are text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/reference_set/reference_case.h"
#include "bench/reference_set/reference_set.h"

namespace todbench {

/// Every key of a sensor as a description.
[[nodiscard]] std::string sensor_description(const SensorSpec& sensor);
/// set.json.
[[nodiscard]] std::string set_description(const ReferenceSetOptions& options,
                                          const std::vector<ReferenceTruth>& truths);
/// README.md: what it is, the columns, how a result is scored, licence.
[[nodiscard]] std::string set_readme(const ReferenceSetOptions& options);
/// Lines "SHA256  PATH" of every file below the folder but SHA256SUMS, sorted. `io`.
[[nodiscard]] Result<std::string> set_sums(const std::filesystem::path& folder);
/// The truths of a set that was written. `invalid_input`: no such folder, no set of this version, or a file that is not
/// what SHA256SUMS says.
[[nodiscard]] Result<std::vector<ReferenceTruth>> read_truths(const std::filesystem::path& folder);

}  // namespace todbench
