// SPDX-License-Identifier: GPL-3.0-or-later
// Movement of the picture by a stage, from requested and observed places.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

namespace todbench {

/// The place of one presentation, in pixels.
struct ShiftSeen {
  int set_up = 0;  ///< places of one set-up have a common origin
  std::int64_t presentation = 0;
  cv::Point2d asked_px;           ///< requested shift in the picture
  cv::Point2d off_px;             ///< observed minus requested
  cv::Point2d standard_error_px;  ///< > 0
};

/// Observed over requested movement, by weighted least squares, with an origin for each set-up.
struct StageFit {
  cv::Matx22d seen_per_asked = cv::Matx22d::eye();  ///< rows: x and y observed; columns: x and y requested
  cv::Matx22d standard_error;
  double chi2 = 0;            ///< of seen_per_asked against the unit matrix, 4 degrees of freedom
  double explained = 0;       ///< share of the squared deviations from the origins that the matrix explains
  double largest_off_px = 0;  ///< of the requested shifts, from their middle
  double largest_off_error_px = 0;
};

/// Empty with fewer than four places, or if the shifts do not span both axes.
[[nodiscard]] std::optional<StageFit> fit_stage(std::span<const ShiftSeen> places);

/// Whether no element of StageFit::seen_per_asked differs from that of the unit matrix by more than `most_deviation`
/// and four standard errors.
[[nodiscard]] bool moves_as_asked(const StageFit& fit, double most_deviation);

/// The movement as a clause: "the stage moves along x with the wrong sign".
[[nodiscard]] std::string motion_clause(const StageFit& fit);

/// Likely cause of wrong places, as a clause: "the stage moves along x with the wrong sign". It needs about six places;
/// with fewer it only states the last one.
[[nodiscard]] std::string likely_cause(std::span<const ShiftSeen> places);

}  // namespace todbench
