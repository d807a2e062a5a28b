// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/share_won.h"

#include <algorithm>
#include <cstddef>

#include "acquisition/base/multiversion.h"

namespace todbench {
namespace {

/// Number of sums compared at once: enough that a comparison need not wait for the preceding one.
constexpr std::size_t lanes = 64;

/// Precondition: at least `lanes` numbers. The last ones may be read twice, which does not change a maximum.
TODBENCH_MULTIVERSION
float best_of_many(const float* signal, const float* noise, float scale, std::size_t count) {
  float top[lanes];
  for (std::size_t l = 0; l < lanes; ++l) top[l] = signal[l] + scale * noise[l];
  for (std::size_t i = lanes; i < count; i += lanes) {
    const std::size_t at = i + lanes <= count ? i : count - lanes;
    for (std::size_t l = 0; l < lanes; ++l) {
      const float value = signal[at + l] + scale * noise[at + l];
      top[l] = value > top[l] ? value : top[l];
    }
  }
  for (std::size_t l = 0; l < 32; ++l) top[l] = top[l + 32] > top[l] ? top[l + 32] : top[l];
  for (std::size_t l = 0; l < 16; ++l) top[l] = top[l + 16] > top[l] ? top[l + 16] : top[l];
  for (std::size_t l = 0; l < 8; ++l) top[l] = top[l + 8] > top[l] ? top[l + 8] : top[l];
  for (std::size_t l = 0; l < 4; ++l) top[l] = top[l + 4] > top[l] ? top[l + 4] : top[l];
  return std::max(std::max(top[0], top[1]), std::max(top[2], top[3]));
}

float best(const float* signal, const float* noise, float scale, std::size_t count) {
  if (count >= lanes) return best_of_many(signal, noise, scale, count);
  float top = signal[0] + scale * noise[0];
  for (std::size_t i = 1; i < count; ++i) top = std::max(top, signal[i] + scale * noise[i]);
  return top;
}

}  // namespace

double share_won(std::span<const float> signal, std::span<const float> noise, float scale, int places, int alternatives,
                 int alternative) {
  const auto count = static_cast<std::size_t>(places);
  const auto maximum = [&](int o) {
    const std::size_t from = static_cast<std::size_t>(o) * count;
    return best(signal.data() + from, noise.data() + from, scale, count);
  };
  const float own = maximum(alternative);
  // Stops at the first alternative with a higher score.
  int equal = 1;
  for (int o = 0; o < alternatives; ++o) {
    if (o == alternative) continue;
    const float other = maximum(o);
    if (other > own) return 0;
    if (other == own) ++equal;
  }
  return 1.0 / equal;
}

}  // namespace todbench
