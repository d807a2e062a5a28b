// SPDX-License-Identifier: GPL-3.0-or-later
// Expanded sweep: a task is a pure function of (file, index).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/sweep/sweep_file.h"

namespace todbench {

/// One task. `parameters`: the varying parameters in the order of the file, without the base.
struct SweepTask {
  std::size_t index = 0;
  std::vector<SweepParameter> parameters;
  std::size_t repeat = 0;
  std::uint64_t seed = 1;  ///< seed of all randomness of the task
  std::string name;        ///< "i000123-HASH": index and hash of all inputs that affect the result
};

/// Function that returns the value of a name that a task does not set: the value of the sensor.
using NumberOfName = std::function<std::optional<double>(std::string_view name)>;

/// All tasks of a sweep. Seeds depend on the content of a task (seed of the sweep, parameters, repeat) and not on its
/// index. Adding or moving a value therefore does not change the results of other tasks. With `paired` the seeds depend
/// on the repeat alone. Immutable, thread-safe.
class Sweep {
 public:
  /// Expands a sweep file. `fingerprint`: other inputs that affect results (contents of named files), part of the hash
  /// of a task. Errors: `invalid_input` (no tasks, more than 10 million tasks, an unknown name in a condition).
  [[nodiscard]] static Result<Sweep> expand(SweepFile file, std::string fingerprint, const NumberOfName& number_of);

  [[nodiscard]] const SweepFile& file() const { return file_; }
  /// Returns the number of tasks.
  [[nodiscard]] std::size_t count() const { return combinations_.size() * file_.repeats; }
  /// Returns a task. Precondition: index < count().
  [[nodiscard]] SweepTask task(std::size_t index) const;
  /// Returns the number of combinations rejected by a condition.
  [[nodiscard]] std::size_t refused() const { return refused_; }
  /// Returns the hash of all inputs that affect any result of this sweep.
  [[nodiscard]] const std::string& hash() const { return hash_; }
  /// Returns the number of combinations per draw: 1, or the number of ranges + 2 with sample_total. The combinations
  /// are then A, B, and A with each parameter of B, in this order.
  [[nodiscard]] std::size_t members() const { return file_.sample_total ? file_.sample.size() + 2 : 1; }
  /// Returns the keys that vary, in the order of the file.
  [[nodiscard]] std::vector<std::string> keys() const;

 private:
  Sweep(SweepFile file, std::string fingerprint);
  void draw();
  [[nodiscard]] std::size_t combination_count() const;
  [[nodiscard]] std::vector<SweepParameter> parameters_of(std::size_t combination) const;
  SweepFile file_;
  std::string base_text_, hash_;
  /// One row for each combination of each draw, with one number for each range.
  std::vector<std::vector<double>> sample_;
  std::vector<std::size_t> combinations_;  ///< combinations that satisfy all conditions
  std::size_t refused_ = 0;
};

/// Draws points in the unit cube: a Latin hypercube, or the Sobol sequence (directions of Joe and Kuo 2008) from its
/// origin with a digital shift by the seed. With 2^m Sobol draws, each of 2^m equal parts of every axis contains one
/// draw. Returns `n` rows of `dimensions` numbers in (0, 1).
[[nodiscard]] std::vector<std::vector<double>> unit_sample(SampleKind kind, std::size_t n, std::size_t dimensions,
                                                           std::uint64_t seed);

}  // namespace todbench
