// SPDX-License-Identifier: GPL-3.0-or-later
// Mean of answers according to the function of a twin, as a function of the parameters of the search.
#pragma once

#include <array>
#include <cstddef>

#include "tod/psychometric/twin_shape.h"

namespace todbench {

/// Parameters: ln size ratio, ln slope ratio, bend (per squared unit of ln size from the threshold), lapse.
using TwinPlace = std::array<double, 4>;
inline constexpr std::size_t twin_size = 0, twin_slope = 1, twin_bend = 2, twin_lapse = 3;

/// Returns the parameters of a fit, without a bend.
[[nodiscard]] TwinPlace twin_place(const TwinShapeUse& use, double lapse);

/// Returns the largest lapse at which the table contains the size with 75 % correct answers; at most max_free_lapse.
[[nodiscard]] double largest_twin_lapse(const TwinShape& shape);

/// Expected proportion correct mu(S) = 1/4 + r (F(c + k d + e d^2) - 1/4). Here d = ln S - ln S75, r = 1 - lapse /
/// (3/4), F: function of the twin, k: slope ratio, e: bend. The constant c solves F(c) = 1/4 + 1/2 / r, so that mu(S75)
/// = 3/4 for every lapse. The argument `shape` must outlive the object.
class TwinMean {
 public:
  TwinMean(const TwinShape& shape, const TwinPlace& place);

  struct Value {
    double value = 0;
    std::array<double, 4> gradient{};  ///< derivative with respect to each parameter
  };
  /// Returns the value at ln(size / mrad).
  [[nodiscard]] Value at(double ln_size) const;

 private:
  const TwinShape& shape_;
  TwinPlace place_;
  double share_ = 1;     ///< r
  double centre_ = 0;    ///< c
  double d_centre_ = 0;  ///< derivative of c with respect to the lapse
};

}  // namespace todbench
