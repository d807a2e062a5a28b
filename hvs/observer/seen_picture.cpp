// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/seen_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hvs/eye/contrast_sensitivity.h"
#include "hvs/eye/eye_optics.h"
#include "hvs/eye/sinc.h"
#include "hvs/observer/identification_bank.h"

namespace todbench {
namespace {

/// Copies of the spectrum of the samples on each side that are summed. The display and the mean over a sample each
/// divide a copy by the square of its number, so that those beyond the sixth leave less than 1e-3.
constexpr int most_copies = 6;

}  // namespace

SeenPicture::SeenPicture(const TemplateObserverSpec& spec, int side)
    : spec_(spec), period_(cv::getOptimalDFTSize(2 * side)) {
  const ViewedDisplay& display = *spec.display;
  const EyeFilter eye(*spec.eye, adaptation_luminance_cd_m2(display));
  const double per_sample = 60 / arcmin_per_sample(display);  // cycles per degree of one cycle per sample
  const double limit = diffraction_limit_per_degree(eye.pupil_mm()) / per_sample;
  const int copies = static_cast<int>(std::min<double>(most_copies, std::ceil(limit)));
  const auto transfer = [&](double u, double w) {
    const double rho = std::hypot(u, w);
    if (rho >= limit) return 0.0;
    return display_transfer(display, u, w) * sinc(u) * sinc(w) * std::sqrt(eye.identification_power(per_sample * rho));
  };
  // Display and eye are even in both axes: one quarter is computed.
  const int half = period_ / 2;
  cv::Mat1f quarter(half + 1, half + 1);
  for (int j = 0; j <= half; ++j) {
    for (int i = 0; i <= j; ++i) {
      double sum = 0;
      for (int m = -copies; m <= copies; ++m) {
        for (int n = -copies; n <= copies; ++n)
          sum += transfer(static_cast<double>(i) / period_ + m, static_cast<double>(j) / period_ + n);
      }
      quarter(j, i) = quarter(i, j) = static_cast<float>(sum);
    }
  }
  factor_.create(period_, period_);
  for (int j = 0; j < period_; ++j) {
    for (int i = 0; i < period_; ++i) factor_(j, i) = quarter(std::min(j, period_ - j), std::min(i, period_ - i));
  }
}

cv::Mat1f SeenPicture::of(const cv::Mat1f& picture) const {
  cv::Mat1f padded = cv::Mat1f::zeros(period_, period_);
  cv::Mat1f inner = padded(cv::Rect({0, 0}, picture.size()));
  without_background(spec_, picture).copyTo(inner);
  cv::Mat spectrum;
  cv::dft(padded, spectrum, cv::DFT_COMPLEX_OUTPUT);
  std::vector<cv::Mat> parts;
  cv::split(spectrum, parts);
  for (cv::Mat& part : parts) part = part.mul(factor_);
  cv::merge(parts, spectrum);
  cv::Mat1f seen;
  cv::dft(spectrum, seen, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  return seen(cv::Rect({0, 0}, picture.size())).clone();
}

}  // namespace todbench
