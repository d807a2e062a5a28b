#include "hvs/observer/score_maxima.h"

#include <algorithm>
#include <cstddef>

#include "acquisition/core/multiversion.h"

namespace todbench {
namespace {

constexpr std::size_t lanes = 32;

TODBENCH_MULTIVERSION
float best(const float* signal, const float* noise, float scale, std::size_t count) {
  float top[lanes];
  for (std::size_t l = 0; l < lanes; ++l) top[l] = signal[0] + scale * noise[0];
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) {
      const float value = signal[i + l] + scale * noise[i + l];
      top[l] = value > top[l] ? value : top[l];
    }
  }
  for (; i < count; ++i) {
    const float value = signal[i] + scale * noise[i];
    top[0] = value > top[0] ? value : top[0];
  }
  return *std::max_element(top, top + lanes);
}

}  // namespace

void score_maxima(std::span<const float> signal, std::span<const float> noise, float scale, int places,
                  std::span<float> maxima) {
  const auto count = static_cast<std::size_t>(places);
  for (std::size_t o = 0; o < maxima.size(); ++o)
    maxima[o] = best(signal.data() + o * count, noise.data() + o * count, scale, count);
}

}  // namespace todbench
