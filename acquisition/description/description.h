// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the description of a GenICam camera before it is evaluated. A camera may state anything; the client that
// evaluates descriptions (Aravis 0.8) follows every reference until the stack overflows, reserves memory by stated
// lengths and divides by register values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/description/description_fault.h"
#include "acquisition/description/description_nodes.h"

namespace todbench {

/// Limits far above every published description: of 92, the longest chain has 19 references, the costliest value 442
/// evaluations, the longest register 32 KiB, the longest formula 2043 characters.
inline constexpr std::size_t longest_reference_chain = 100;
inline constexpr std::uint64_t most_evaluations = 10'000;
inline constexpr std::int64_t longest_register_bytes = 64 * 1024;
inline constexpr std::size_t longest_formula = 16 * 1024;

/// A parsed description with its faults. A value; any thread.
class Description {
 public:
  explicit Description(std::string_view xml);

  /// Reasons why the description must not be evaluated at all; empty: it is safe.
  [[nodiscard]] const std::vector<DescriptionFault>& faults() const { return faults_; }
  /// Reasons why this feature must not be evaluated: it depends on a node that does not exist (and would count as 0),
  /// or on a division that traps the processor. Empty for a feature that does not exist.
  [[nodiscard]] std::vector<DescriptionFault> faults_of(const std::string& feature) const;
  /// Nodes whose values, known only to the camera, are lengths of registers that this feature depends on; each node
  /// after the nodes it depends on. Check that they are 1 ... 64 KiB before evaluating the feature.
  [[nodiscard]] std::vector<std::string> lengths_of(const std::string& feature) const;

 private:
  DescriptionNodes nodes_;
  std::vector<DescriptionFault> faults_;
  std::vector<bool> trapping_;                  ///< by node
  std::vector<std::string> unbounded_lengths_;  ///< sorted
};

}  // namespace todbench
