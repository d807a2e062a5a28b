// SPDX-License-Identifier: GPL-3.0-or-later
// Straight line of an edge in a picture, and the distances of the pixels from this line.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measures/edge_spline.h"

namespace todbench {

/// The line x = middle + slope (row - middle row), in pixels.
struct EdgeLine {
  double middle = 0, slope = 0;
  double middle_row = 0;
  [[nodiscard]] double at(int row) const { return middle + slope * (row - middle_row); }
  [[nodiscard]] double cosine() const;
};

/// A pixel as a sample of the edge's profile.
struct EdgeSample {
  double t = 0;  ///< distance from the line along its normal, in pitches; the bright side has t > 0
  double value = 0;
  int row = 0;
};

/// Returns a first estimate of the line of an edge whose bright side is on the right. The position in each row is
/// computed from the sum of the row. Error: `invalid_input` (no step between the left and the right border of the
/// picture).
[[nodiscard]] Result<EdgeLine> first_line(const cv::Mat1d& picture);

/// Returns the pixels within `reach` pitches of the line.
[[nodiscard]] std::vector<EdgeSample> samples_near(const cv::Mat1d& picture, const EdgeLine& line, double reach);

/// Returns the distance to which the profile extends on both sides of the line in at least three quarters of the rows,
/// at most 32 pitches. Negative if a part of the line is outside the picture.
[[nodiscard]] double reach_of(const cv::Size& size, const EdgeLine& line);

/// Returns the displacement of each row's edge from the line along the normal, in pitches, positive towards the bright
/// side (least squares against the profile).
[[nodiscard]] std::vector<double> row_offsets(const std::vector<EdgeSample>& samples, const Spline& profile, int rows);

/// Parabola through the offsets of the rows: its coefficients, and the standard uncertainty of the sag.
struct RowTrend {
  double mean = 0, slope = 0;  ///< mean offset, and slope per row
  double sag = 0, sag_u = 0;   ///< offset of the outermost rows minus offset of the middle row, without the slope
};
/// Fits the parabola by least squares.
[[nodiscard]] RowTrend trend_of(const std::vector<double>& offsets);

}  // namespace todbench
