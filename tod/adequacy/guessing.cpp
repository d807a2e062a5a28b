// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/guessing.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <functional>
#include <map>
#include <utility>

namespace todbench {

double p_guessed(std::span<const Level> levels) {
  std::map<double, std::pair<double, double>, std::greater<>> by_size;  // right, all; the largest size first
  for (const Level& level : levels) {
    if (!(level.size > 0) || !(level.total > 0)) continue;
    auto& [right, all] = by_size[level.size];
    right += level.correct, all += level.total;
  }
  constexpr double guess = 0.25;
  double right = 0, all = 0, least = 1;
  for (const auto& [size, counts] : by_size) {
    right += counts.first, all += counts.second;
    // Probability of at least `right` of `all`: the regularised incomplete beta function.
    if (right > 0) least = std::min(least, boost::math::ibeta(right, all - right + 1, guess));
  }
  return std::min(1.0, least * static_cast<double>(by_size.size()));
}

}  // namespace todbench
