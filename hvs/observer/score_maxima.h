// The inner loop of estimates that work on projected noise: best score per alternative.
#pragma once

#include <span>

namespace todbench {

/// For each alternative o: the maximum over its `places` scores of signal + scale * noise. `signal` and `noise` hold
/// maxima.size() * places scores or more. The same bits on every instruction set (no sum is reordered).
void score_maxima(std::span<const float> signal, std::span<const float> noise, float scale, int places,
                  std::span<float> maxima);

}  // namespace todbench
