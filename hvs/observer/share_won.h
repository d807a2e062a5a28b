// SPDX-License-Identifier: GPL-3.0-or-later
// Inner loop of estimates with projected noise: finds the alternative with the highest score.
#pragma once

#include <span>

namespace todbench {

/// Returns 1 if the score of `alternative` is above all others, 0 if another one is above it, and its equal share on a
/// tie. The score of an alternative is the maximum over its `places` scores of signal + scale * noise. `signal` and
/// `noise` hold at least alternatives * places scores. Bit-identical on every instruction set (no sum is reordered).
[[nodiscard]] double share_won(std::span<const float> signal, std::span<const float> noise, float scale, int places,
                               int alternatives, int alternative);

}  // namespace todbench
