// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the description of a GenICam camera before it is evaluated. A camera may state arbitrary contents. The client
// that evaluates descriptions (Aravis 0.8) follows every reference until the stack overflows, allocates memory by
// stated lengths and divides by register values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/description/description_fault.h"
#include "acquisition/description/description_nodes.h"

namespace todbench {

/// Limits far above the values of all published descriptions. In 92 published descriptions, the longest chain has 19
/// references, the costliest value needs 442 evaluations, the longest register has 32 KiB, and the longest formula has
/// 2043 characters.
inline constexpr std::size_t longest_reference_chain = 100;
inline constexpr std::uint64_t most_evaluations = 10'000;
inline constexpr std::int64_t longest_register_bytes = 64 * 1024;
inline constexpr std::size_t longest_formula = 16 * 1024;

/// A parsed description with its faults. A value type; any thread.
class Description {
 public:
  explicit Description(std::string_view xml);

  /// Returns the reasons why the description must not be evaluated at all; empty: it is safe.
  [[nodiscard]] const std::vector<DescriptionFault>& faults() const { return faults_; }
  /// Returns the reasons why this feature must not be evaluated. A feature must not depend on a node that does not
  /// exist, because the client would use the value 0, or on a division that can raise SIGFPE. Empty for a feature that
  /// does not exist.
  [[nodiscard]] std::vector<DescriptionFault> faults_of(const std::string& feature) const;
  /// Returns the nodes with the lengths of registers on which this feature depends, if only the camera stores these
  /// lengths. In the list, each node follows the nodes on which it depends. Check that the values are 1 ... 64 KiB
  /// before evaluating the feature.
  [[nodiscard]] std::vector<std::string> lengths_of(const std::string& feature) const;

 private:
  DescriptionNodes nodes_;
  std::vector<DescriptionFault> faults_;
  std::vector<bool> trapping_;                  ///< for each node, whether its evaluation can raise SIGFPE
  std::vector<std::string> unbounded_lengths_;  ///< sorted
};

}  // namespace todbench
