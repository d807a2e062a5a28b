// SPDX-License-Identifier: GPL-3.0-or-later
// Temporal noise: white, independent in each sample and exposure.
#include <algorithm>
#include <cmath>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

void add_temporal_noise(cv::Mat1f& picture, const SensorSpec& spec, const NoiseStreams& streams, double weight) {
  const RandomStream stream = streams("temporal", 0);
  const auto sd = static_cast<float>(weight * spec.netd_k);
  constexpr std::size_t strip = 4096;  // stays in the first-level cache
  float noise[strip];
  const auto count = static_cast<std::size_t>(picture.total());
  auto* pixels = picture.ptr<float>();
  for (std::size_t first = 0; first < count; first += strip) {
    const std::size_t n = std::min(strip, count - first);
    stream.fill_normal(std::span(noise, n), first);
    for (std::size_t i = 0; i < n; ++i) pixels[first + i] += sd * noise[i];
  }
}

}  // namespace

EffectRow effect_rows::temporal_noise() {
  EffectRow row;
  row.title = "Temporal noise";
  row.keys = {{"netd_k", &SensorSpec::netd_k, NumberRange::between(0, 5), KeyPresence::required,
               "temporal noise per sample, referred to the scene"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.netd_k == 0; };
  row.neutralise = [](SensorSpec& spec) { spec.netd_k = 0; };
  row.neutral = "netd_k is 0";
  row.stage = stage::Noise{stage::Colour::white, stage::Recurrence::every_exposure, add_temporal_noise};
  row.white_variance_k2 = [](const SensorSpec& spec, double noise_factor) {
    const double sd = spec.netd_k * noise_factor / std::sqrt(spec.exposures_per_sample());
    return sd * sd;
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return scene.noise_change(-scene.variance_of(Effect::temporal_noise));
  };
  return row;
}

}  // namespace todbench
