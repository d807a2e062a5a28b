// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/formula_curves.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/range/bars_sampled.h"

namespace todbench {
namespace {

constexpr int wavelengths = 16;

/// MTF along one axis, in cycles per detector pitch. The eye averages frames, so image dance acts as blur.
class AxisMtf {
 public:
  AxisMtf(const SensorSpec& spec, BarAxis axis)
      : axis_(axis == BarAxis::horizontal ? PitchAxis::x : PitchAxis::y),
        plan_(full_plan(spec, {Effect::image_dance}, {})),
        optics_(spec, plan_, wavelengths),
        footprint_({.spec = spec, .plan = plan_}) {}
  [[nodiscard]] double operator()(double f_per_pitch) const {
    return optics_(f_per_pitch) * footprint_(f_per_pitch, axis_);
  }

 private:
  PitchAxis axis_;
  SensorPlan plan_;
  OpticsMtf optics_;
  FootprintMtf footprint_;
};

/// Table of a smooth transfer function, up to its cut-off or 4 cycles per sample: linear between 16384 values, with
/// errors below 1e-7.
class Tabulated {
 public:
  explicit Tabulated(const std::function<double(double)>& transfer) {
    for (int i = 0; i <= steps; ++i) values_.push_back(transfer(highest * i / steps));
    while (values_.size() > 2 && std::abs(values_.back()) < 1e-9) values_.pop_back();
  }
  [[nodiscard]] double band() const { return highest * static_cast<double>(values_.size() - 1) / steps; }
  [[nodiscard]] double operator()(double f) const {
    const double place = std::min(f / highest * steps, static_cast<double>(values_.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(place), values_.size() - 2);
    const double w = place - static_cast<double>(i);
    return values_[i] + w * (values_[i + 1] - values_[i]);
  }

 private:
  static constexpr int steps = 16384;
  static constexpr double highest = 4;
  std::vector<double> values_;
};

double nyquist_per_mrad(const SensorSpec& spec) {
  return 0.5 * spec.samples_per_pitch() / spec.ifov_mrad();
}

/// Frequencies in equal steps from 1 % of the highest.
std::vector<double> frequencies_up_to(double highest, int count) {
  std::vector<double> frequencies;
  for (int i = 0; i < count; ++i) frequencies.push_back(highest * (0.01 + 0.99 * i / (count - 1)));
  return frequencies;
}

/// Integral of |channel|^2 df over both signs for the eye's channel exp(-2.2 ln^2(f / centre)): centre sqrt(pi / 4.4)
/// exp(1 / 17.6) per side.
double channel_width(double centre) {
  return 2 * centre * std::sqrt(std::numbers::pi / 4.4) * std::exp(1 / 17.6);
}

/// Mean over the eye's channel of the change of noise density by samples that share a detector; across the bars the
/// displayed samples keep their variance. Computed in ln(f / centre), in which |channel|^2 df is a Gaussian of variance
/// 1 / 8.8 times the frequency, with 33 points over 4 standard deviations to both sides.
double shared_in_channel(const MrtdFormula& formula, double centre) {
  if (formula.samples_per_detector == 1) return 1;
  constexpr int steps = 16;
  double sum = 0, weights = 0;
  for (int i = -steps; i <= steps; ++i) {
    const double x = 4.0 * i / steps / std::sqrt(8.8);
    const double weight = std::exp(-4.4 * x * x + x);
    weights += weight;
    sum += weight * shared_density(formula.samples_per_detector, centre * std::exp(x) * formula.pitch_mrad);
  }
  return sum / weights;
}

/// MTF of a displayed square sample, at a frequency in cycles/mrad of the scene.
double sample_mtf(double f_per_mrad, double sample_mrad) {
  const double x = std::numbers::pi * f_per_mrad * sample_mrad;
  return x == 0 ? 1 : std::abs(std::sin(x) / x);
}

/// Noise of the channel over the scene contrast, squared: density NETD^2 p^2 / F times the channel along the axis and a
/// displayed sample across it, plus the other components of this axis.
double noise_power(const MrtdFormula& formula, const FormulaConditions& conditions, double f, BarAxis axis) {
  const double along = channel_width(f);
  const double across = 1 / formula.pitch_mrad;  // int sinc^2(u p) du
  const double white = formula.netd_k * formula.netd_k * formula.pitch_mrad * formula.pitch_mrad;
  const NoiseRatios& n = formula.noise;
  const double fixed_s = conditions.eye_integration_s;  // the eye does not average constant noise
  const double line = axis == BarAxis::horizontal ? n.th : n.tv;
  const double lines_only = axis == BarAxis::horizontal ? n.h : n.v;
  const double density_s = (1 + line * line) / formula.frame_rate_hz +
                           (n.vh * n.vh * shared_in_channel(formula, f) + lines_only * lines_only) * fixed_s;
  const double seen = conditions.alpha_root_hz / conditions.scene_contrast_k;
  return seen * seen * white * along * across * density_s;
}

double axis_ctf(const SensorSpec& spec, const AxisMtf& mtf, const MrtdFormula& formula,
                const FormulaConditions& conditions, double f, BarAxis axis) {
  // The display magnifies angles of the scene by this factor.
  const double magnification = conditions.sample_at_eye_mrad / formula.pitch_mrad;
  const double cycles_per_degree = f / magnification * 1000 * std::numbers::pi / 180;
  const double passed = mtf(f * spec.ifov_mrad()) * sample_mtf(f, formula.pitch_mrad);
  return eye_contrast_threshold(cycles_per_degree, conditions.eye) / passed *
         std::sqrt(1 + noise_power(formula, conditions, f, axis));
}

}  // namespace

Result<MrtdFormula> mrtd_formula_of(const SensorSpec& spec, const FormulaConditions& conditions) {
  TODBENCH_TRY_VOID(require_square_pixels(spec, "a formula for the MRTD or the range"));
  if (!(spec.netd_k > 0))
    return fail(ErrorCode::invalid_input, "sensor " + spec.name + ": the MRTD formula needs temporal noise");
  MrtdFormula formula;
  formula.pitch_mrad = spec.ifov_mrad() / spec.samples_per_pitch();
  // Averaged exposures lower the noise of a picture and its rate; displaced exposures of a finer grid lower the rate.
  const int averaged = spec.exposures_per_sample();
  const int per_picture = averaged * spec.samples_per_pitch() * spec.samples_per_pitch();
  formula.netd_k = spec.netd_k / std::sqrt(averaged);
  formula.frame_rate_hz = spec.frame_rate_hz / per_picture;
  formula.samples_per_detector = spec.samples_per_pitch();
  formula.eye_integration_s = conditions.eye_integration_s;
  formula.snr_threshold = conditions.snr_threshold;
  formula.noise = {.vh = spec.fixed_pattern_k / formula.netd_k,
                   .th = spec.column_noise_k / spec.netd_k,
                   .tv = spec.row_noise_k / spec.netd_k,
                   .h = 0,
                   .v = 0};
  return formula;
}

Result<AxisCurves> mrtd_curves(const SensorSpec& spec, const FormulaConditions& conditions) {
  TODBENCH_TRY(const auto formula, mrtd_formula_of(spec, conditions));
  const auto along = [&](BarAxis axis) {
    const AxisMtf mtf(spec, axis);
    std::vector<CurvePoint> points;
    for (const double f : frequencies_up_to(nyquist_per_mrad(spec), 100)) {
      const double passed = mtf(f * spec.ifov_mrad());
      if (!(passed > 1e-6)) break;
      points.push_back({f, mrtd_k(formula, f, passed, axis)});
    }
    return LogLinearCurve::of(points, "MRTD");
  };
  auto h = along(BarAxis::horizontal), v = along(BarAxis::vertical);
  if (!h) return tl::unexpected(h.error());
  if (!v) return tl::unexpected(v.error());
  return AxisCurves{*std::move(h), *std::move(v)};
}

namespace {

/// Frequency in cycles per mrad, and the modulation of four bars at the best phase.
using BarModulations = std::vector<std::pair<double, double>>;

BarModulations best_modulations(const SensorSpec& spec, double pitch_mrad, BarAxis axis) {
  const AxisMtf mtf(spec, axis);
  const int n = spec.samples_per_pitch();
  // In samples: the lattice of the modulation has a step of 1.
  const Tabulated per_sample([&](double f) { return mtf(f * n); });
  // Blur does not affect bars of fifty samples.
  const double nyquist = nyquist_per_mrad(spec);
  BarModulations out{{0.01 * nyquist, 1}};
  constexpr int count = 80, phases = 16;
  const auto adds = [&](double f) {
    const BlurredBars bars(
        f * pitch_mrad, [&](double u) { return per_sample(u); }, per_sample.band());
    const BarModulation left = bar_modulation(bars, phases);
    if (left.best < 0.01 || left.bars_separated_at_best < 2) return false;
    out.emplace_back(f, left.best);
    return true;
  };
  double last = 0;
  for (int i = 0; i < count; ++i) {
    const double f = nyquist * (0.1 + 1.9 * i / (count - 1));
    if (adds(f)) {
      last = f;
      continue;
    }
    // The end of the curve is the range of every target of high contrast: a coarse step would change it by up to 2 %.
    for (double beyond = f; last > 0 && beyond - last > 2e-4 * nyquist;) {
      const double middle = 0.5 * (last + beyond);
      (adds(middle) ? last : beyond) = middle;
    }
    break;
  }
  return out;
}

}  // namespace

Result<AxisCurves> mtdp_like_curves(const SensorSpec& spec, const FormulaConditions& conditions) {
  TODBENCH_TRY(const auto formula, mrtd_formula_of(spec, conditions));
  const BarModulations horizontal = best_modulations(spec, formula.pitch_mrad, BarAxis::horizontal);
  const auto curve = [&](const BarModulations& of, BarAxis axis) {
    std::vector<CurvePoint> points;
    for (const auto& [f, modulation] : of) points.push_back({f, mtdp_like_k(formula, f, modulation, axis)});
    return LogLinearCurve::of(points, "MTDP-like");
  };
  auto h = curve(horizontal, BarAxis::horizontal);
  auto v = curve(spec.square_detector() ? horizontal : best_modulations(spec, formula.pitch_mrad, BarAxis::vertical),
                 BarAxis::vertical);
  if (!h) return tl::unexpected(h.error());
  if (!v) return tl::unexpected(v.error());
  return AxisCurves{*std::move(h), *std::move(v)};
}

Result<LogLinearCurve> system_ctf(const SensorSpec& spec, const FormulaConditions& conditions) {
  // A sensor without temporal noise still has a threshold, from eye and transfer function.
  SensorSpec noisy = spec;
  noisy.netd_k = std::max(spec.netd_k, 1e-12);
  TODBENCH_TRY(const auto formula, mrtd_formula_of(noisy, conditions));
  const AxisMtf along_x(spec, BarAxis::horizontal), along_y(spec, BarAxis::vertical);
  std::vector<CurvePoint> points;
  for (const double f : frequencies_up_to(nyquist_per_mrad(spec), 200)) {
    if (!(std::min(along_x(f * spec.ifov_mrad()), along_y(f * spec.ifov_mrad())) > 1e-9)) break;
    const double h = axis_ctf(spec, along_x, formula, conditions, f, BarAxis::horizontal);
    const double v = axis_ctf(spec, along_y, formula, conditions, f, BarAxis::vertical);
    const double mean = std::sqrt(h) * std::sqrt(v);
    if (!std::isfinite(mean)) break;
    points.push_back({f, mean});
  }
  return LogLinearCurve::of(points, "CTF");
}

}  // namespace todbench
