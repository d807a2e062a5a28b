// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_display.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "hvs/shape/gauss_legendre.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

constexpr int tap_reach = 8;

}  // namespace

std::vector<double> taps_of(const std::function<double(double)>& response) {
  std::vector<double> taps(2 * tap_reach + 1, 0.0);
  double sum = 0;
  for (int k = 0; k <= tap_reach; ++k) {
    double integral = 0;
    for (const auto& [x, weight] : gauss_legendre(48)) {
      const double f = 0.25 + 0.25 * x;  // 0 to 1/2; the negative half is the same
      integral += 0.5 * weight * response(f) * std::cos(2 * std::numbers::pi * f * k);
    }
    taps[static_cast<std::size_t>(tap_reach + k)] = taps[static_cast<std::size_t>(tap_reach - k)] = integral;
    sum += (k == 0 ? 1 : 2) * integral;
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

double display_response(const SensorSpec& spec, double f_per_sample) {
  const double angle = std::numbers::pi * f_per_sample;
  const double boost = 1 + 4 * spec.edge_boost * std::pow(std::sin(angle), 2);
  const double filtered = boost * std::exp(-2 * std::pow(angle * spec.display_blur_samples, 2));
  if (spec.display == DisplayReconstruction::sample_and_hold || angle == 0) return filtered;
  return filtered * std::sin(angle) / angle;
}

bool has_display(const SensorSpec& spec) {
  return spec.display != DisplayReconstruction::sample_and_hold || spec.display_blur_samples > 0 || spec.edge_boost > 0;
}

double display_noise_gain(const SensorSpec& spec) {
  if (!has_display(spec)) return 1;
  double squares = 0;
  for (const double tap : taps_of([&](double f) { return display_response(spec, f); })) squares += tap * tap;
  return squares;  // its root for each axis
}

cv::Mat1f filtered(const cv::Mat1f& picture, const std::vector<double>& taps) {
  cv::Mat1f out;
  cv::sepFilter2D(picture, out, CV_32F, taps, taps, {-1, -1}, 0, cv::BORDER_REFLECT_101);
  return out;
}

EffectRow effect_rows::display() {
  EffectRow row;
  row.title = "Display reconstruction";
  row.keys = {{"display", &SensorSpec::display, NumberRange::any(), KeyPresence::optional,
               "reconstruction of the picture from samples: sample_and_hold or bilinear"},
              {"display_blur_samples", &SensorSpec::display_blur_samples, NumberRange::between(0, 3),
               KeyPresence::optional, "sigma of the display's blur per axis, in displayed samples"},
              {"edge_boost", &SensorSpec::edge_boost, NumberRange::between(0, 4), KeyPresence::optional,
               "strength b of the camera's edge filter per axis: taps -b, 1 + 2 b, -b on its samples"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return !has_display(spec); };
  row.neutralise = [](SensorSpec& spec) {
    spec.display = DisplayReconstruction::sample_and_hold;
    spec.display_blur_samples = 0;
    spec.edge_boost = 0;
  };
  row.neutral = "sample and hold without blur and edge filter";
  row.stage = stage::Picture{[](const SensorSpec& spec, const NoiseStreams&) -> PictureStage {
    return [taps = taps_of([&](double f) { return display_response(spec, f); })](cv::Mat1f& picture) {
      picture = filtered(picture, taps);
    };
  }};
  row.always = "always simulated: no criterion covers the edge filter of a camera";
  // No bound for an edge filter. Otherwise twice the observed change: 1.1 % for a blur of 0.2 samples, rising as its
  // square, and 2.7 % for bilinear.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    if (scene.spec.edge_boost > 0) return std::nullopt;
    return 0.025 * std::pow(scene.spec.display_blur_samples / 0.2, 2) +
           (scene.spec.display == DisplayReconstruction::bilinear ? 0.027 : 0);
  };
  return row;
}

}  // namespace todbench
