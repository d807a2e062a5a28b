// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_image_dance.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "sim_devices/sensor/memory_weights.h"

namespace todbench {
namespace {

double aperture_m(const SensorSpec& spec) {
  return spec.focal_length_mm / spec.f_number / 1000;
}

/// Relative variance of the mean over a time T of a process with correlation exp(-t / a); x = T / a.
double of_mean(double x) {
  return x < 1e-4 ? 1 - x / 3 : 2 * (x - 1 + std::exp(-x)) / (x * x);
}

/// Correlation between successive exposures. Pictures come at the frame rate and have several exposures each.
double memory_of_exposure(const SensorSpec& spec) {
  return std::exp(-1000 / (spec.turbulence_correlation_ms * spec.frame_rate_hz * spec.exposures_per_sample()));
}

}  // namespace

double dance_share(const SensorSpec& spec) {
  const double a = spec.turbulence_correlation_ms;
  if (a == 0) return 0;
  double b = spec.time_constant_ms;
  if (b == 0) return of_mean(spec.exposure_ms / a);
  // Spectrum 2 a / ((1 + w^2 a^2) (1 + w^2 b^2)) sinc^2(w T / 2) in partial fractions; equal times are a limit.
  if (std::abs(b / a - 1) < 1e-5) b = a * (1 + 1e-5);
  const double own = a * of_mean(spec.exposure_ms / a), of_detector = b * of_mean(spec.exposure_ms / b);
  return a * (own - of_detector) / (a * a - b * b);
}

double dance_weight(const SensorSpec& spec) {
  const auto path = turbulent_path(spec);
  if (!path) return 0;
  const double fresnel_m = std::sqrt(path->wavelength_um * 1e-6 * path->path_m);
  return aperture_m(spec) >= fresnel_m ? 1 : 0.5;
}

double dance_cut_off(const SensorSpec& spec) {
  const auto path = turbulent_path(spec);
  return path ? aperture_m(spec) * spec.ifov_mrad() * 1e-3 / (path->wavelength_um * 1e-6) : 0;
}

double dance_sd_pitch(const SensorSpec& spec) {
  if (!lets_dance(spec)) return 0;
  // 6.88 / (4 pi^2) (D / r0)^(5/3) (lambda / D)^2, expressed by the long exposure's exponent at one cycle per pitch.
  const double variance = turbulence_strength(spec) / (2 * std::numbers::pi * std::numbers::pi) /
                          std::cbrt(dance_cut_off(spec)) * dance_weight(spec) * dance_share(spec);
  return std::sqrt(variance);
}

double dance_correlation(const SensorSpec& spec) {
  return spec.turbulence_correlation_ms == 0 ? 0 : memory_of_exposure(spec);
}

bool lets_dance(const SensorSpec& spec) {
  return spec.turbulence_correlation_ms > 0 && turbulent_path(spec).has_value();
}

double averaged_dance_bound(const SensorSpec& spec, const SensorSpec& instant, double s75_pitch) {
  const double with = dance_sd_pitch(spec), without = dance_sd_pitch(instant);
  return 12 * std::abs(without * without - with * with) / (s75_pitch * s75_pitch);
}

ImageDance::ImageDance(const SensorSpec& spec) : sd_pitch_(dance_sd_pitch(spec)), aspect_(spec.pitch_aspect()) {
  if (!still()) weights_ = memory_weights(dance_correlation(spec));
}

cv::Point2d ImageDance::displacement_pitch(const RandomStream& stream, std::uint64_t exposure) const {
  cv::Point2d sum{0, 0};
  for (std::size_t ago = 0; ago < weights_.size(); ++ago) {
    // Exposures before the first have random numbers, too: 2^64 - 1 and so on.
    const RandomStream own = stream.sub(exposure - ago);
    sum += weights_[ago] * cv::Point2d(own.normal(0), own.normal(1));
  }
  return sd_pitch_ * cv::Point2d(sum.x, sum.y / aspect_);
}

std::vector<cv::Point2d> spread_dance_pitch(const SensorSpec& spec, std::uint64_t index) {
  const double sd = dance_sd_pitch(spec);
  if (sd == 0) return {};
  // Additive recurrence with the plastic number, in normal deviates.
  const double g = 1.3247179572447460;
  const auto deviate = [](double turns) {
    const double share = turns - std::floor(turns);
    return std::numbers::sqrt2 * boost::math::erf_inv(std::clamp(2 * share - 1, -1 + 1e-9, 1 - 1e-9));
  };
  const int exposures = spec.exposures_per_sample();
  const double memory = dance_correlation(spec), fresh = std::sqrt(1 - memory * memory);
  std::vector<cv::Point2d> out;
  for (int k = 0; k < exposures; ++k) {
    const double at = 0.5 + static_cast<double>(index * static_cast<std::uint64_t>(exposures)) + k;
    const cv::Point2d own(sd * deviate(at / g), sd * deviate(at / (g * g)) / spec.pitch_aspect());
    out.push_back(k == 0 ? own : memory * out.back() + fresh * own);
  }
  return out;
}

int dances_per_phase(const SensorSpec& spec, int phases_per_axis) {
  const int n = spec.samples_per_pitch();
  const double sd_samples = dance_sd_pitch(spec) * n, fineness = phases_per_axis / 8.0;
  // For an observer that searches one sample far, and a dance of 0.9 samples, the error of the threshold is 2.7, 0.9
  // and 0.1 % with 16, 64 and 256 displacements.
  constexpr double needed_at_one_sample = 300;
  constexpr int most = 64;
  const double needed = needed_at_one_sample * std::pow(sd_samples * fineness, 2);
  const double phases = std::pow(std::max(1, phases_per_axis / n), 2);
  return static_cast<int>(std::clamp(std::ceil(needed / phases), 1.0, static_cast<double>(most)));
}

EffectRow effect_rows::image_dance() {
  EffectRow row;
  row.title = "Image dance";
  row.keys = {{"turbulence_correlation_ms", &SensorSpec::turbulence_correlation_ms, NumberRange::between(0, 10000),
               KeyPresence::optional,
               "correlation time of the image dance behind turbulent air; shorter frames are displaced and sharper; 0: "
               "every frame is the long exposure"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return !lets_dance(spec); };
  row.neutralise = [](SensorSpec& spec) { spec.turbulence_correlation_ms = 0; };
  row.neutral = "turbulence_correlation_ms is 0, or there is no turbulence";
  row.stage = stage::Dance{};
  // Without the effect the dance is blur: 12 / S^2 times its variance per axis, as for every blur.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    const double sd = dance_sd_pitch(scene.spec);
    return 12 * sd * sd / (scene.s75_pitch * scene.s75_pitch);
  };
  return row;
}

}  // namespace todbench
