// What is wrong with the description of a GenICam camera, before anybody evaluates it. A camera may state anything; the
// client that evaluates descriptions (Aravis 0.8) follows every reference until the stack ends, reserves what a length
// says and divides by what a register holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/description/description_fault.h"
#include "acquisition/description/description_nodes.h"

namespace todbench {

/// Limits that no published description comes near: of 92 the longest chain has 19 references, the costliest value 442
/// evaluations, the longest register 32 KiB, the longest formula 2043 characters.
inline constexpr std::size_t longest_reference_chain = 100;
inline constexpr std::uint64_t most_evaluations = 10'000;
inline constexpr std::int64_t longest_register_bytes = 64 * 1024;
inline constexpr std::size_t longest_formula = 16 * 1024;

/// A value; any thread.
class Description {
 public:
  explicit Description(std::string_view xml);

  /// Why the description must not be evaluated at all; empty: it may be.
  [[nodiscard]] const std::vector<DescriptionFault>& faults() const { return faults_; }
  /// Why this feature must not be: something that it depends on does not exist, and would count as 0, or divides such
  /// that the processor traps. Empty for a feature that does not exist.
  [[nodiscard]] std::vector<DescriptionFault> faults_of(const std::string& feature) const;
  /// Nodes whose values, known only to the camera, are lengths of registers that this feature depends on; each after
  /// those that it depends on itself. Whoever evaluates the feature looks first whether they are 1 ... 64 KiB.
  [[nodiscard]] std::vector<std::string> lengths_of(const std::string& feature) const;

 private:
  DescriptionNodes nodes_;
  std::vector<DescriptionFault> faults_;
  std::vector<bool> trapping_;                  ///< by node
  std::vector<std::string> unbounded_lengths_;  ///< sorted
};

}  // namespace todbench
