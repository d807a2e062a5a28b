// SPDX-License-Identifier: GPL-3.0-or-later
// Temporal noise with memory: first-order autoregressive from exposure to exposure, with the variance of white noise.
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/memory_weights.h"

namespace todbench {
namespace {

/// The picture already contains the white noise; the added noise gives the sum its memory.
void add_correlated_noise(cv::Mat1f& picture, const SensorSpec& spec, const NoiseStreams& streams, double weight) {
  std::vector<double> terms = memory_weights(spec.noise_correlation);
  terms[0] -= 1;
  constexpr std::size_t strip = 4096;  // stays in the first-level cache
  float noise[strip];
  const auto count = static_cast<std::size_t>(picture.total());
  auto* pixels = picture.ptr<float>();
  for (std::size_t ago = 0; ago < terms.size(); ++ago) {
    const RandomStream stream = streams("temporal", ago);
    const auto sd = static_cast<float>(weight * spec.netd_k * terms[ago]);
    for (std::size_t first = 0; first < count; first += strip) {
      const std::size_t n = std::min(strip, count - first);
      stream.fill_normal(std::span(noise, n), first);
      for (std::size_t i = 0; i < n; ++i) pixels[first + i] += sd * noise[i];
    }
  }
}

/// The mean of n exposures has the variance of one times (1 + 2 sum over k < n of (1 - k / n) rho^k) / n. The sum is
/// the excess over white noise. A single exposure is unchanged.
double excess(const SensorSpec& spec) {
  const int n = spec.exposures_per_sample();
  double sum = 0, power = 1;
  for (int k = 1; k < n; ++k) {
    power *= spec.noise_correlation;
    sum += 2 * (1 - static_cast<double>(k) / n) * power;
  }
  return sum / n;
}

}  // namespace

EffectRow effect_rows::correlated_noise() {
  EffectRow row;
  row.title = "Correlated temporal noise";
  row.keys = {{"noise_correlation", &SensorSpec::noise_correlation, NumberRange::between(0, 0.99),
               KeyPresence::optional, "first-order correlation of a sample's temporal noise in successive exposures"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.noise_correlation == 0 || spec.netd_k == 0; };
  row.neutralise = [](SensorSpec& spec) { spec.noise_correlation = 0; };
  row.neutral = "noise_correlation or netd_k is 0";
  row.stage = stage::Noise{stage::Colour::white, stage::Recurrence::every_exposure, add_correlated_noise};
  row.white_variance_k2 = [](const SensorSpec& spec, double noise_factor) {
    const double sd = spec.netd_k * noise_factor;
    return sd * sd * excess(spec);
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return scene.noise_change(-scene.variance_of(Effect::correlated_noise));
  };
  row.always = "simulated: it determines the correlation of the noise of successive frames, which the run measures";
  row.when_bounded = WhenBounded::simulated;
  return row;
}

}  // namespace todbench
