// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_distortion.h"

#include <algorithm>
#include <cmath>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

constexpr double polynomial_to = 1.2;  // of R: the corners of a barrel show places beyond R
constexpr double farthest_px = 0.5;    // pitches; beyond it the bound does not hold

struct RadialLens {
  double k1, k2;

  [[nodiscard]] double factor(double s) const { return 1 + s * (k1 + s * k2); }
  /// Relative displacement at a radius over R.
  [[nodiscard]] double stretch(double radius) const {
    if (radius <= polynomial_to) return factor(radius * radius);
    constexpr double s = polynomial_to * polynomial_to;
    const double slope = 1 + s * (3 * k1 + 5 * s * k2);
    return (polynomial_to * factor(s) + slope * (radius - polynomial_to)) / radius;
  }
  /// Bound on the second derivative of the place along any line, times R.
  [[nodiscard]] double curvature() const {
    return 6 * polynomial_to * std::abs(k1) + 20 * std::pow(polynomial_to, 3) * std::abs(k2);
  }
};

RadialLens lens_of(const SensorSpec& spec) {
  constexpr double percent = 0.01;
  return {percent * spec.distortion_percent, percent * spec.distortion_r4_percent};
}

cv::Point2d middle_of(cv::Size size) {
  return {0.5 * (size.width - 1), 0.5 * (size.height - 1)};
}

/// Half the diagonal, in samples along x.
double corner_of(cv::Size size, const SensorSpec& spec) {
  return 0.5 * std::hypot(size.width, size.height * spec.pitch_aspect());
}

}  // namespace

bool distorts(const SensorSpec& spec) {
  return spec.distortion_percent != 0 || spec.distortion_r4_percent != 0;
}

cv::Point2d as_lens_shows(cv::Point2d place, const SensorSpec& spec, cv::Size size) {
  if (!distorts(spec)) return place;
  const cv::Point2d p = place - middle_of(size);
  return middle_of(size) +
         p * lens_of(spec).stretch(std::hypot(p.x, p.y * spec.pitch_aspect()) / corner_of(size, spec));
}

Polygon as_lens_shows(const Polygon& outline, const SensorSpec& spec, cv::Size size) {
  constexpr double within = 0.002;
  const double aspect = spec.pitch_aspect();
  // Per sample of the axis with the smaller pitch.
  const double curvature = lens_of(spec).curvature() / corner_of(size, spec) * std::max(aspect, 1 / aspect);
  Polygon seen;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const cv::Point2d from = outline[k], along = outline[(k + 1) % outline.size()] - from;
    // Distance between an arc and its chord: length^2 / 8 times the curvature.
    const double pieces = std::ceil(std::hypot(along.x, along.y) * std::sqrt(curvature / (8 * within)));
    for (int i = 0; i < std::max(1.0, pieces); ++i)
      seen.push_back(as_lens_shows(from + along * (i / std::max(1.0, pieces)), spec, size));
  }
  return seen;
}

EffectRow effect_rows::distortion() {
  EffectRow row;
  row.title = "Lens distortion";
  row.keys = {
      {"distortion_percent", &SensorSpec::distortion_percent, NumberRange::between(-10, 10), KeyPresence::optional,
       "displacement of the corner by the third power of the radius, in percent of its radius; positive: pincushion"},
      {"distortion_r4_percent", &SensorSpec::distortion_r4_percent, NumberRange::between(-3, 3), KeyPresence::optional,
       "the same for the fifth power of the radius"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return !distorts(spec); };
  row.neutralise = [](SensorSpec& spec) { spec.distortion_percent = spec.distortion_r4_percent = 0; };
  row.neutral = "distortion_percent and distortion_r4_percent are 0";
  row.directions = AxisDirections::different;
  row.stage = stage::Lens{};
  // A stretch of 3 k1 + 5 k2 along the radius and k1 + k2 across it changes sizes and turns edges by less than the
  // former. The observer finds the target at its place as long as no place moves by more than half a pitch.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    const RadialLens lens = lens_of(scene.spec);
    const double k1 = std::abs(lens.k1), k2 = std::abs(lens.k2);
    const double most_samples = std::max(1.0, 1 / scene.spec.pitch_aspect());
    if ((k1 + k2) * most_samples * corner_of({scene.spec.width, scene.spec.height}, scene.spec) > farthest_px)
      return std::nullopt;
    return 3 * k1 + 5 * k2;
  };
  row.always = "always simulated: the lens displaces image points by more than half a pitch";
  return row;
}

}  // namespace todbench
