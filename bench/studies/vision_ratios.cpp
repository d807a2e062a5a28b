// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/vision_ratios.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "acquisition/base/distributions.h"
#include "hvs/observer/naked_eye.h"
#include "hvs/shape/polygon.h"

namespace todbench {
namespace {

/// The x in [low, high] at which a rising function passes 0.
template <typename Function>
double zero_of(double low, double high, Function function) {
  while (high - low > 1e-9) {
    const double middle = (low + high) / 2;
    (function(middle) < 0 ? low : high) = middle;
  }
  return low;
}

/// A block E with strokes of 1 and a side of 5, its centre at the origin.
Polygon block_e() {
  return {{-2.5, -2.5}, {2.5, -2.5}, {2.5, -1.5}, {-1.5, -1.5}, {-1.5, -0.5}, {2.5, -0.5},
          {2.5, 0.5},   {-1.5, 0.5}, {-1.5, 1.5}, {2.5, 1.5},   {2.5, 2.5},   {-2.5, 2.5}};
}

double detection_over_recognition(const EyeParameters& eye) {
  constexpr double side_deg = 50.0 / 60;
  const Polygon letter = block_e();
  const NakedEyeShape shape(letter);
  const double size_deg = side_deg * std::sqrt(area(letter)) / 5;
  const EyeFilter filter(eye, assumed_cd_m2);
  // The products are those of identification, which has less uncertainty than detection.
  const double gain = detection_d_prime(eye.uncertainty_channels) / detection_d_prime(1);
  const double detection = two_alternatives * gain / std::sqrt(shape.products(filter, size_deg)[0]);
  return detection / shape.threshold_contrast(filter, eye.contrast_noise, size_deg, acuity_share)
                         .value_or(std::numeric_limits<double>::quiet_NaN());
}

/// 1/arcmin of a stripe of the finest grating, black and white in a Gaussian window, that is detected.
double grating_acuity(const EyeParameters& eye) {
  constexpr double fundamental = 4 / std::numbers::pi, window_deg = 0.5;
  const EyeFilter filter(eye, much_light_cd_m2);
  const double finest = zero_of(1, 100, [&](double frequency) {
    return two_alternatives - fundamental * filter.gabor_d_prime(frequency, window_deg);
  });
  return 2 * finest / 60;
}

/// Slope of the Weibull function of two-alternative forced choice between a contrast far above threshold and a larger
/// one, where it has its threshold. The noise of each is in proportion to its contrast.
double discrimination_slope(const EyeParameters& eye) {
  constexpr double at_threshold = 1 - 0.5 / std::numbers::e, step = 1e-4, least_noise = 1e-6;
  const double noise = std::max(eye.contrast_noise, least_noise);
  const auto correct = [&](double ln_increment) {
    const double increment = std::exp(ln_increment);
    return cdf(distribution::Normal(), increment / (noise * std::hypot(1, 1 + increment)));
  };
  const double threshold = zero_of(-20, 0, [&](double x) { return correct(x) - at_threshold; });
  return 2 * std::numbers::e * (correct(threshold + step) - correct(threshold - step)) / (2 * step);
}

/// Whether the only figure is off by more than a quarter.
bool fails(const VisionKind& kind) {
  return std::abs(errors_of(kind).largest) > 0.1;
}

}  // namespace

std::vector<VisionKind> vision_ratios(const EyeParameters& eye, double ring_acuity_per_arcmin) {
  VisionKind letters{.name = "detection_over_recognition",
                     .title = "Detection against recognition",
                     .quantity = "contrast for detection over contrast for recognition",
                     .error = VisionError::log10,
                     .failure = {},
                     .source =
                         "Liu and Gauthier 2004 (abstract): twelve shapes made from a block E, 50 arcmin, 5 people; "
                         "recognition needs 3 to 3.5 times the contrast of detection",
                     .remark =
                         "Another task: the twelve shapes are not published, and four orientations of a block E "
                         "differ more. Luminance (100 cd/m2) and criteria (84 % of two, 62.5 % of four) are assumed.",
                     .points = {{"block E, 50 arcmin", 1 / 3.25, detection_over_recognition(eye)}}};
  if (fails(letters))
    letters.failure = fmt::format(
        "The model tells the orientation of a large letter at {:.1f} times the contrast at which it detects it; people "
        "recognise letters at 3 to 3.5 times the contrast of detection.",
        1 / letters.points[0].model);
  VisionKind gratings{.name = "grating_over_ring",
                      .title = "Acuity for gratings against rings",
                      .quantity = "acuity for stripes over acuity for the gap of a ring",
                      .error = VisionError::log10,
                      .failure = {},
                      .source = "Shlaer 1937, J. Gen. Physiol. 21, 165-188 (abstract): about 30 % lower, 2 people",
                      .remark =
                          "Luminance (3000 cd/m2), window (Gaussian, 0.5 degrees) and criteria (84 % of two, 62.5 % of "
                          "four) are assumed.",
                      .points = {{"much light", 0.7, grating_acuity(eye) / ring_acuity_per_arcmin}}};
  if (fails(gratings))
    gratings.failure = fmt::format(
        "The finest stripes that the model sees are {:.2f} times as wide as the gap of a ring; those of people are 1.4 "
        "times as wide.",
        1 / gratings.points[0].model);
  VisionKind slope{
      .name = "discrimination_slope",
      .title = "Slope of contrast discrimination",
      .quantity = "slope of the Weibull function",
      .error = VisionError::log10,
      .failure = {},
      .source = "May and Solomon 2013, PLoS ONE 8, e74815: median of published functions, 0.8 to 2.4",
      .remark =
          "The noise of the model is Gaussian and in proportion to the contrast, which fixes the slope: no "
          "other parameter of the eye changes it.",
      .points = {{"two-alternative forced choice, above threshold", 1.43, discrimination_slope(eye)}}};
  return {std::move(letters), std::move(gratings), std::move(slope)};
}

}  // namespace todbench
