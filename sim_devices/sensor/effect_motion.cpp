// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_motion.h"

#include <cmath>
#include <numbers>

#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

constexpr double strongest_motion = 0.5;  // pitches per time constant; beyond it the bound does not hold

/// In pitches along x.
double length_of(const SensorSpec& spec, SceneMotion motion) {
  const cv::Point2d smear = smear_pitch(spec, motion);
  return std::hypot(smear.x, smear.y * spec.pitch_aspect());
}

}  // namespace

std::complex<double> motion_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d smear_pitch) {
  const double phase = 2 * std::numbers::pi * (u_per_pitch * smear_pitch.x + w_per_pitch * smear_pitch.y);
  return std::polar(1.0, -phase) / std::complex<double>(1, -phase);
}

cv::Point2d moved_pitch(const SensorSpec& spec, SceneMotion motion, double seconds) {
  const double pitches_per_mrad_s = seconds / spec.ifov_mrad();
  return {motion.x_mrad_s * pitches_per_mrad_s, motion.y_mrad_s * pitches_per_mrad_s / spec.pitch_aspect()};
}

cv::Point2d smear_pitch(const SensorSpec& spec, SceneMotion motion) {
  return moved_pitch(spec, motion, spec.time_constant_ms * 1e-3);
}

EffectRow effect_rows::motion() {
  EffectRow row;
  row.title = "Motion and time constant";
  row.keys = {{"time_constant_ms", &SensorSpec::time_constant_ms, NumberRange::between(0, 1000), KeyPresence::optional,
               "time constant of the bolometer; 0: a detector without memory"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    // Bolometers have 1 ms and more; 0.01 is one of 10 ms, stated in seconds.
    const bool memory = spec.time_constant_ms > 0 && spec.time_constant_ms < 0.05;
    return memory ? "time_constant_ms must be 0, or 0.05 to 1000; is the value in s?" : "";
  };
  row.is_neutral = [](const SensorSpec& spec, SceneMotion motion) {
    return spec.time_constant_ms == 0 || (!motion.moving() && !lets_dance(spec));
  };
  row.neutralise = [](SensorSpec& spec) { spec.time_constant_ms = 0; };
  row.neutral = "time_constant_ms is 0, or neither target nor picture moves";
  row.directions = AxisDirections::different;
  row.stage = stage::Transfer{[](const ChainScope& scope) -> TransferFunction {
    const cv::Point2d smear = smear_pitch(scope.spec, scope.motion);
    if (smear == cv::Point2d(0, 0)) return {};
    return [smear](double u, double w) { return motion_transfer(u, w, smear); };
  }};
  // After fourteen smears the tail of a moving target has fallen to e^-14 = 1e-6.
  row.spread = [](const ChainScope& scope) {
    const double tail = 14 * length_of(scope.spec, scope.motion);
    return Spread{.period = tail, .window = tail, .variance = 0};
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    const double v_tau = length_of(scene.spec, scene.motion);
    if (v_tau >= strongest_motion) return std::nullopt;
    SensorSpec instant = scene.spec;
    instant.time_constant_ms = 0;
    return 12 * v_tau * v_tau / 2 / (scene.s75_pitch * scene.s75_pitch) +
           averaged_dance_bound(scene.spec, instant, scene.s75_pitch);
  };
  row.always =
      "always simulated: motion of at least half a pitch per time constant is outside the range of the criterion";
  return row;
}

}  // namespace todbench
