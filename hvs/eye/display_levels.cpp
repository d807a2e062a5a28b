// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/eye/display_levels.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace todbench {

LevelContrasts level_contrasts(const ViewedDisplay& display) {
  LevelContrasts out{};
  const double background = adaptation_luminance_cd_m2(display);
  for (std::size_t level = 0; level < out.size(); ++level) {
    const double luminance =
        luminance_cd_m2(display, static_cast<double>(level) / static_cast<double>(out.size() - 1)) + display.veil_cd_m2;
    out[level] = (luminance - background) / background;
  }
  return out;
}

BetweenLevels between_levels(const LevelContrasts& contrasts, double contrast) {
  const auto above = std::upper_bound(contrasts.begin() + 1, contrasts.end() - 1, contrast);
  const double low = *(above - 1), step = *above - low;
  return {.below = static_cast<int>(above - contrasts.begin()) - 1,
          .share = step > 0 ? std::clamp((contrast - low) / step, 0.0, 1.0) : 0,
          .step = step};
}

int background_level_of(const ViewedDisplay& display) {
  const BetweenLevels at = between_levels(level_contrasts(display), 0);
  return at.below + static_cast<int>(std::lround(at.share));
}

cv::Mat1b operator_picture(const ViewedDisplay& display, const cv::Mat1d& kelvin, double contrast_k) {
  const LevelContrasts contrasts = level_contrasts(display);
  const BetweenLevels background = between_levels(contrasts, 0);
  const double middle = background.below + background.share;
  // With the gain of the operator in luminance contrast, with a fixed gain in levels.
  const bool fixed_gain = display.span_k > 0;
  const double scale = fixed_gain ? 255 / display.span_k : display.contrast / std::abs(contrast_k);
  const auto zoom = static_cast<int>(display.zoom);
  cv::Mat1d fine;
  cv::resize(kelvin * scale, fine, {}, zoom, zoom,
             display.interpolation == DisplayInterpolation::linear ? cv::INTER_LINEAR : cv::INTER_NEAREST);
  cv::Mat1b out(fine.size());
  std::transform(fine.begin(), fine.end(), out.begin(), [&](double value) {
    if (fixed_gain) return cv::saturate_cast<unsigned char>(middle + value);
    const BetweenLevels at = between_levels(contrasts, value);
    return static_cast<unsigned char>(at.below + static_cast<int>(std::lround(at.share)));
  });
  return out;
}

}  // namespace todbench
