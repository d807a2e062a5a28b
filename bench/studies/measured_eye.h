// SPDX-License-Identifier: GPL-3.0-or-later
// Eye model for comparison with published figures of people.
#pragma once

#include <cmath>
#include <limits>

#include "bench/studies/vision_ratios.h"
#include "hvs/observer/naked_eye.h"

namespace todbench {

/// Eye model and its thresholds for Landolt rings.
class MeasuredEye {
 public:
  explicit MeasuredEye(const EyeParameters& eye) : eye_(eye) {}
  /// Returns the filter of the eye at a luminance.
  [[nodiscard]] EyeFilter at(double luminance_cd_m2) const { return {eye_, luminance_cd_m2}; }
  /// Returns the acuity in 1/arcmin: 1 / gap of the smallest Landolt ring that the eye recognises. NaN: the eye
  /// recognises no ring at this contrast.
  [[nodiscard]] double acuity(double luminance_cd_m2, double contrast) const {
    const auto size = ring_.threshold_deg(at(luminance_cd_m2), eye_.contrast_noise, contrast, acuity_share);
    return size ? sqrt_area_ / (60 * *size) : std::numeric_limits<double>::quiet_NaN();
  }
  /// Returns the threshold contrast of a Landolt ring whose gap is `gap_arcmin`; NaN: the eye does not recognise it at
  /// any contrast.
  [[nodiscard]] double threshold_contrast(double luminance_cd_m2, double gap_arcmin) const {
    return ring_
        .threshold_contrast(at(luminance_cd_m2), eye_.contrast_noise, gap_arcmin / 60 * sqrt_area_, acuity_share)
        .value_or(std::numeric_limits<double>::quiet_NaN());
  }

 private:
  EyeParameters eye_;
  NakedEyeShape ring_{landolt_ring()};
  double sqrt_area_ = std::sqrt(area(landolt_ring()));
};

}  // namespace todbench
