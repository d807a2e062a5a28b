// SPDX-License-Identifier: GPL-3.0-or-later
// One offset per detector, the same in every frame; the samples of a microscan cycle share it.
#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

void add_fixed_pattern(cv::Mat1f& picture, const SensorSpec& spec, const NoiseStreams& streams, double weight) {
  const int n = spec.samples_per_pitch();
  cv::Mat1f detectors(picture.rows / n, picture.cols / n);
  streams("fixed", 0).fill_normal(std::span(detectors.ptr<float>(), detectors.total()));
  const auto sd = static_cast<float>(weight * spec.fixed_pattern_k);
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) picture(row, column) += sd * detectors(row / n, column / n);
  }
}

}  // namespace

EffectRow effect_rows::fixed_pattern() {
  EffectRow row;
  row.title = "Fixed-pattern noise";
  row.keys = {{"fixed_pattern_k", &SensorSpec::fixed_pattern_k, NumberRange::between(0, 10), KeyPresence::optional,
               "standard deviation of the fixed offset of a detector"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.fixed_pattern_k == 0; };
  row.neutralise = [](SensorSpec& spec) { spec.fixed_pattern_k = 0; };
  row.neutral = "fixed_pattern_k is 0";
  row.stage = stage::Noise{stage::Colour::coloured, stage::Recurrence::fixed, add_fixed_pattern};
  // Bound for a pattern shared by n x n samples.
  row.coloured_variance = [](const NoiseScope& scope) {
    const double n2 = scope.spec.samples_per_pitch() * scope.spec.samples_per_pitch();
    return n2 * scope.spec.fixed_pattern_k * scope.spec.fixed_pattern_k / scope.contrast_k2;
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return scene.noise_change(-scene.variance_of(Effect::fixed_pattern));
  };
  return row;
}

}  // namespace todbench
