// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_exposure.h"

#include <cmath>
#include <numbers>

#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_motion.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

constexpr double longest_way = 1;  // pitch per exposure; beyond it the bound does not hold

/// In pitches along x.
double exposure_way_length(const SensorSpec& spec, SceneMotion motion) {
  const cv::Point2d way = exposure_way_pitch(spec, motion);
  return std::hypot(way.x, way.y * spec.pitch_aspect());
}

}  // namespace

double exposure_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d way_pitch) {
  const double x = std::numbers::pi * (u_per_pitch * way_pitch.x + w_per_pitch * way_pitch.y);
  return x == 0 ? 1 : std::sin(x) / x;
}

cv::Point2d exposure_way_pitch(const SensorSpec& spec, SceneMotion motion) {
  return moved_pitch(spec, motion, spec.exposure_ms * 1e-3);
}

cv::Point2d mean_lag_pitch(const SensorSpec& spec, SceneMotion motion) {
  return smear_pitch(spec, motion) + exposure_way_pitch(spec, motion) / 2;
}

EffectRow effect_rows::exposure() {
  EffectRow row;
  row.title = "Exposure time";
  row.keys = {{"exposure_ms", &SensorSpec::exposure_ms, NumberRange::between(0, 1000), KeyPresence::optional,
               "exposure time of a detector that integrates and holds; 0: short compared with all motion"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    if (spec.exposure_ms * spec.frame_rate_hz <= 1000 * (1 + 1e-9)) return "";
    return "exposure_ms must not be longer than the frame period";
  };
  row.is_neutral = [](const SensorSpec& spec, SceneMotion motion) {
    return spec.exposure_ms == 0 || (!motion.moving() && !lets_dance(spec));
  };
  row.neutralise = [](SensorSpec& spec) { spec.exposure_ms = 0; };
  row.neutral = "exposure_ms is 0, or neither target nor picture moves";
  row.directions = AxisDirections::different;
  row.stage = stage::Transfer{[](const ChainScope& scope) -> TransferFunction {
    const cv::Point2d way = exposure_way_pitch(scope.spec, scope.motion);
    if (way == cv::Point2d(0, 0)) return {};
    return [way](double u, double w) { return std::complex<double>(exposure_transfer(u, w, way), 0); };
  }};
  row.spread = [](const ChainScope& scope) {
    const double way = exposure_way_length(scope.spec, scope.motion);
    return Spread{.period = way, .window = way, .variance = 0};
  };
  // As for the time constant: 12 / S^2 times the variance of the smear per axis, b^2 / 12 along the path.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    const double way = exposure_way_length(scene.spec, scene.motion);
    if (way >= longest_way) return std::nullopt;
    SensorSpec instant = scene.spec;
    instant.exposure_ms = 0;
    return way * way / 2 / (scene.s75_pitch * scene.s75_pitch) +
           averaged_dance_bound(scene.spec, instant, scene.s75_pitch);
  };
  row.always = "always simulated: motion of at least a pitch per exposure is outside the range of the criterion";
  return row;
}

}  // namespace todbench
