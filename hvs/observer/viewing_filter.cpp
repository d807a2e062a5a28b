// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/viewing_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hvs/eye/contrast_sensitivity.h"
#include "hvs/eye/eye_optics.h"
#include "hvs/eye/sinc.h"

namespace todbench {
namespace {

/// Display (sample and hold over one sample) and blur of display and eye together: sinc(u) sinc(w) exp(-2 pi^2 sigma^2
/// rho^2), with w in rho divided by the height of a sample.
TransferFunction blurring_filter(double sigma_samples, double aspect) {
  return [sigma_samples, aspect](double u, double w) -> std::complex<double> {
    const double pi_sigma = std::numbers::pi * sigma_samples;
    const double v = w / aspect;
    return sinc(u) * sinc(w) * std::exp(-2 * pi_sigma * pi_sigma * (u * u + v * v));
  };
}

/// Frequency at which the Gaussian has fallen to 1e-12, in cycles per sample: exp(-2 pi^2 sigma^2 f^2) = 1e-12.
double filter_band(double sigma_samples) {
  return std::sqrt(27.631 / 2) / (std::numbers::pi * sigma_samples);
}

/// Display twice and H^2: the display draws a sample of the patch, and the template is the shape behind the display.
ViewingFilter seeing_filter(const TemplateObserverSpec& spec) {
  const ViewedDisplay& display = *spec.display;
  const EyeFilter eye(*spec.eye, adaptation_luminance_cd_m2(display));
  const double per_sample = 60 / arcmin_per_sample(display);  // cycles per degree of one cycle per sample
  // Values fall with the square of the spectrum of a displayed sample. Those below 1e-6 of the peak change the
  // covariance of the noise by less than 1e-7, because the spectrum of the shape falls as well.
  double peak = 0, band = 0;
  const double limit = diffraction_limit_per_degree(eye.pupil_mm());
  for (double f = limit / 400; f < limit; f += limit / 400) {
    const double envelope = std::min(1.0, std::pow(std::numbers::pi * f / per_sample, -2));
    const double value = eye.identification_power(f) * envelope;
    peak = std::max(peak, value);
    if (value > 1e-6 * peak) band = f;
  }
  // The cusp of the diffraction MTF leaves an algebraic tail: copies this far away change the covariance by 5e-7.
  constexpr double reach_arcmin = 24;
  return {[display, eye, per_sample](double u, double w) -> std::complex<double> {
            const double transfer = display_transfer(display, u, w);
            return eye.identification_power(per_sample * std::hypot(u, w)) * transfer * transfer;
          },
          band / per_sample, reach_arcmin / arcmin_per_sample(display) + 1};
}

}  // namespace

ViewingFilter viewing_filter(const TemplateObserverSpec& spec) {
  if (spec.eye) return seeing_filter(spec);
  const double sigma = spec.blur_sigma_samples;
  return {blurring_filter(sigma, spec.sample_aspect), filter_band(sigma) * std::max(1.0, spec.sample_aspect),
          7 * sigma};
}

}  // namespace todbench
