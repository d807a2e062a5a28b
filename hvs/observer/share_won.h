// The inner loop of estimates that work on projected noise: which alternative's best score is the highest.
#pragma once

#include <span>

namespace todbench {

/// The score of an alternative is the maximum over its `places` scores of signal + scale * noise. 1 where that of
/// `alternative` is above those of all the others, 0 where another's is above it, its fair part where they are equal.
/// `signal` and `noise` hold alternatives * places scores or more. The same bits on every instruction set (no sum is
/// reordered).
[[nodiscard]] double share_won(std::span<const float> signal, std::span<const float> noise, float scale, int places,
                               int alternatives, int alternative);

}  // namespace todbench
