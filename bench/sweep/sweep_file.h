// SPDX-License-Identifier: GPL-3.0-or-later
// Content of a sweep file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/sweep/constraint.h"

namespace todbench {

/// Parameter and its value, as text of a form or of the command line: "0.05", "draft", "16.9, 1.93".
struct SweepParameter {
  std::string key;
  std::string value;
  bool operator==(const SweepParameter&) const = default;
};
/// A parameter with its values in order.
struct SweepAxis {
  std::string key;
  std::vector<std::string> values;
};
/// Parameter drawn between two limits.
struct SweepRange {
  std::string key;
  double low = 0, high = 1;
};
/// Kind of sample.
enum class SampleKind { latin_hypercube, sobol };

/// Computation of a task.
enum class TaskKind {
  simulate,  ///< trials and fit, as `todbench simulate`
  estimate,  ///< the direct estimate without trials
  identify,  ///< an observer identifies the targets of a set, as `todbench identify`
};

/// Content of a sweep file.
struct SweepFile {
  std::string name;
  std::uint64_t seed = 1;
  /// If true, seeds depend on the repeat alone, for paired comparisons.
  bool paired = false;
  TaskKind kind = TaskKind::simulate;
  std::vector<SweepParameter> base;
  std::vector<SweepAxis> grid;  ///< full factorial; the last axis varies fastest
  std::vector<SweepAxis> zip;   ///< axes of equal length that vary together
  SampleKind sample_kind = SampleKind::latin_hypercube;
  std::vector<SweepRange> sample;
  std::size_t sample_count = 0;
  std::uint64_t sample_seed = 1;
  /// Only for a Sobol sample. If true, every draw consists of two independent points A and B, and a further point for
  /// each range. This point is a copy of A in which the parameter of the range has the value of B. With R ranges there
  /// are sample_count x (R + 2) combinations, from which the total indices (Saltelli et al. 2010) are computed.
  bool sample_total = false;
  std::size_t repeats = 1;
  std::vector<Constraint> where;
  std::filesystem::path folder;   ///< folder of the file, to which the paths in the file are relative
  std::filesystem::path results;  ///< folder of the results
};

/// Reads [base], [grid], [zip], [sample], [repeat], name, seed, paired, kind, where. The keys of [grid] stay in the
/// order of the file. A table { from, to, steps } stands for a list of equidistant values. Errors: `invalid_input`
/// "FILE:LINE: ...".
[[nodiscard]] Result<SweepFile> read_sweep(const std::filesystem::path& file);
/// Parses the text of a sweep file. `file`: name of the text in messages.
[[nodiscard]] Result<SweepFile> parse_sweep(std::string_view text, const std::filesystem::path& file);

}  // namespace todbench
