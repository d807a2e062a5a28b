// SPDX-License-Identifier: GPL-3.0-or-later
// Inner loop of estimates with projected noise: finds the alternative with the highest score.
#pragma once

#include <span>

namespace todbench {

/// Returns 1 if `alternative` has the highest score, and 0 if another alternative has a higher score. If n alternatives
/// share the highest score, it returns 1 / n for each of these alternatives. The score of an alternative is the maximum
/// over its `places` scores of signal + scale * noise. `signal` and `noise` have at least alternatives * places
/// elements. Bit-identical on every instruction set (no sum is reordered).
[[nodiscard]] double share_won(std::span<const float> signal, std::span<const float> noise, float scale, int places,
                               int alternatives, int alternative);

}  // namespace todbench
