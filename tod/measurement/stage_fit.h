// SPDX-License-Identifier: GPL-3.0-or-later
// Fit of the motion in the picture to the requested shifts of a stage.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

namespace todbench {

/// Position of the plate in one presentation, in pixels.
struct ShiftSeen {
  int set_up = 0;  ///< positions of one set-up have a common origin
  std::int64_t presentation = 0;
  cv::Point2d asked_px;           ///< requested shift in the picture
  cv::Point2d off_px;             ///< observed minus requested
  cv::Point2d standard_error_px;  ///< > 0
};

/// Linear relation between observed and requested motion, by weighted least squares. The origin of each set-up is
/// fitted separately.
struct StageFit {
  cv::Matx22d seen_per_asked = cv::Matx22d::eye();  ///< rows: x and y observed; columns: x and y requested
  cv::Matx22d standard_error;
  double chi2 = 0;            ///< chi-square of seen_per_asked relative to the unit matrix, 4 degrees of freedom
  double explained = 0;       ///< share of the squared deviations (observed minus requested) that the matrix explains
  double largest_off_px = 0;  ///< largest deviation of a fitted shift from the requested shift, after removal of the
                              ///< origins
  double largest_off_error_px = 0;  ///< standard error of largest_off_px, per axis
};

/// Fits the motion. Empty with fewer than four positions, or if the shifts do not span both axes.
[[nodiscard]] std::optional<StageFit> fit_stage(std::span<const ShiftSeen> places);

/// Returns whether every element of StageFit::seen_per_asked differs from the unit matrix by at most `most_deviation`
/// plus four standard errors.
[[nodiscard]] bool moves_as_asked(const StageFit& fit, double most_deviation);

/// Returns the motion as a clause, for example "the stage moves along x with the wrong sign".
[[nodiscard]] std::string motion_clause(const StageFit& fit);

/// Returns the likely cause of wrong positions as a clause, for example "the stage moves along x with the wrong sign".
/// With fewer than six positions, only a single displacement of the picture is detected. If no cause is found, the
/// clause states the deviation of the last position. Precondition: `places` is not empty.
[[nodiscard]] std::string likely_cause(std::span<const ShiftSeen> places);

}  // namespace todbench
