// A sweep as its file states it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/sweep/constraint.h"

namespace todbench {

/// A value of a parameter: the text that a form or the command line would take, "0.05", "draft", "16.9, 1.93".
struct SweepParameter {
  std::string key;
  std::string value;
  bool operator==(const SweepParameter&) const = default;
};
/// A parameter with the values that it takes, in their order.
struct SweepAxis {
  std::string key;
  std::vector<std::string> values;
};
/// A parameter that is drawn between two ends.
struct SweepRange {
  std::string key;
  double low = 0, high = 1;
};
enum class SampleKind { latin_hypercube, sobol };

/// What a task computes.
enum class TaskKind {
  simulate,  ///< trials and fit, as `todbench simulate`
  estimate,  ///< the direct estimate without trials
};

struct SweepFile {
  std::string name;
  std::uint64_t seed = 1;
  /// Seeds depend on the repeat alone: paired comparisons.
  bool paired = false;
  TaskKind kind = TaskKind::simulate;
  std::vector<SweepParameter> base;
  std::vector<SweepAxis> grid;  ///< full factorial, the last fastest
  std::vector<SweepAxis> zip;   ///< all of one length, taken together
  SampleKind sample_kind = SampleKind::latin_hypercube;
  std::vector<SweepRange> sample;
  std::size_t sample_count = 0;
  std::uint64_t sample_seed = 1;
  /// Of a Sobol sample: every draw is a pair A, B of independent ones and, for each parameter, A with that of B, so
  /// that total indices can be had (Saltelli et al. 2010): sample_count (ranges + 2) combinations.
  bool sample_total = false;
  std::size_t repeats = 1;
  std::vector<Constraint> where;
  std::filesystem::path folder;   ///< of the file: what it names is relative to it
  std::filesystem::path results;  ///< where results go
};

/// [base], [grid], [zip], [sample], [repeat], name, seed, paired, kind, where. Keys of [grid] in the order of the file;
/// { from, to, steps } is a list. `invalid_input` "FILE:LINE: ..." in one sentence.
[[nodiscard]] Result<SweepFile> read_sweep(const std::filesystem::path& file);
[[nodiscard]] Result<SweepFile> parse_sweep(std::string_view text, const std::filesystem::path& file);

}  // namespace todbench
