// SPDX-License-Identifier: GPL-3.0-or-later
// Row and column noise: one offset per row or column of detectors, new in every exposure and at every position of the
// microscan. sample = detector * n + position.
#include <cmath>
#include <vector>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

std::vector<float> normals(const RandomStream& stream, int count) {
  std::vector<float> out(static_cast<std::size_t>(count));
  stream.fill_normal(out);
  return out;
}

void add_row_column_noise(cv::Mat1f& picture, const SensorSpec& spec, const NoiseStreams& streams, double weight) {
  const int n = spec.samples_per_pitch();
  if (spec.row_noise_k > 0) {
    // One random number per sample row and position along it.
    const auto offsets = normals(streams("rows", 0), picture.rows * n);
    const auto sd = static_cast<float>(weight * spec.row_noise_k);
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.cols; ++column)
        picture(row, column) += sd * offsets[static_cast<std::size_t>(row * n + column % n)];
    }
  }
  if (spec.column_noise_k > 0) {
    const auto offsets = normals(streams("columns", 0), picture.cols * n);
    const auto sd = static_cast<float>(weight * spec.column_noise_k);
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.cols; ++column)
        picture(row, column) += sd * offsets[static_cast<std::size_t>(column * n + row % n)];
    }
  }
}

/// Equivalent white noise: the variance that moves the differences between templates equally. The search may find
/// places with a larger effect, hence the factor of 1.5.
double as_white(const NoiseScope& scope, double sd_k, SharedBy line) {
  if (sd_k == 0) return 0;
  return 1.5 * scope.variance_ratio(line) * std::pow(sd_k, 2) / scope.spec.exposures_per_sample() / scope.contrast_k2;
}

}  // namespace

EffectRow effect_rows::row_column_noise() {
  EffectRow row;
  row.title = "Row and column noise";
  row.keys = {{"row_noise_k", &SensorSpec::row_noise_k, NumberRange::between(0, 10), KeyPresence::optional,
               "standard deviation of the offset of a row of detectors, new in every exposure"},
              {"column_noise_k", &SensorSpec::column_noise_k, NumberRange::between(0, 10), KeyPresence::optional,
               "the same for a column"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) {
    return spec.row_noise_k == 0 && spec.column_noise_k == 0;
  };
  row.neutralise = [](SensorSpec& spec) { spec.row_noise_k = spec.column_noise_k = 0; };
  row.neutral = "row_noise_k and column_noise_k are 0";
  row.directions = AxisDirections::different;
  row.stage = stage::Noise{stage::Colour::coloured, stage::Recurrence::every_exposure, add_row_column_noise};
  row.coloured_variance = [](const NoiseScope& scope) {
    return as_white(scope, scope.spec.row_noise_k, SharedBy::row) +
           as_white(scope, scope.spec.column_noise_k, SharedBy::column);
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return scene.noise_change(-scene.variance_of(Effect::row_column_noise));
  };
  return row;
}

}  // namespace todbench
