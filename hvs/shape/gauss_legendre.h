// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Legendre quadrature.
#pragma once

#include <vector>

namespace todbench {

/// A node of a quadrature rule.
struct QuadratureNode {
  double x = 0;       ///< in (-1, 1)
  double weight = 0;  ///< the weights sum to 2
};

/// Returns the rule on [-1, 1] with `count` >= 1 nodes in increasing order. Nodes and weights are accurate to a few
/// units in the last place (Newton's method on the Legendre recurrence).
[[nodiscard]] std::vector<QuadratureNode> gauss_legendre(int count);

}  // namespace todbench
