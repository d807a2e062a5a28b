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

/// A value of a parameter, as text of a form or the command line: "0.05", "draft", "16.9, 1.93".
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
/// A parameter drawn between two ends.
struct SweepRange {
  std::string key;
  double low = 0, high = 1;
};
enum class SampleKind { latin_hypercube, sobol };

/// Computation of a task.
enum class TaskKind {
  simulate,  ///< trials and fit, as `todbench simulate`
  estimate,  ///< the direct estimate without trials
  identify,  ///< an observer identifies the targets of a set, as `todbench identify`
};

struct SweepFile {
  std::string name;
  std::uint64_t seed = 1;
  /// Seeds depend on the repeat alone: for paired comparisons.
  bool paired = false;
  TaskKind kind = TaskKind::simulate;
  std::vector<SweepParameter> base;
  std::vector<SweepAxis> grid;  ///< full factorial, the last varies fastest
  std::vector<SweepAxis> zip;   ///< all of one length, varied together
  SampleKind sample_kind = SampleKind::latin_hypercube;
  std::vector<SweepRange> sample;
  std::size_t sample_count = 0;
  std::uint64_t sample_seed = 1;
  /// For a Sobol sample: every draw is a pair A, B of independent ones and, for each parameter, A with that of B, which
  /// gives total indices (Saltelli et al. 2010): sample_count (ranges + 2) combinations.
  bool sample_total = false;
  std::size_t repeats = 1;
  std::vector<Constraint> where;
  std::filesystem::path folder;   ///< of the file: its paths are relative to it
  std::filesystem::path results;  ///< folder of the results
};

/// Reads [base], [grid], [zip], [sample], [repeat], name, seed, paired, kind, where. Keys of [grid] keep the order of
/// the file; { from, to, steps } is a list. Errors: `invalid_input` "FILE:LINE: ..." in one sentence.
[[nodiscard]] Result<SweepFile> read_sweep(const std::filesystem::path& file);
[[nodiscard]] Result<SweepFile> parse_sweep(std::string_view text, const std::filesystem::path& file);

}  // namespace todbench
