// The straight line of an edge in a picture, and the picture's pixels by their distance from it.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/measures/edge_spline.h"

namespace todbench {

/// x = middle + slope (row - middle row), in pixels.
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

/// A first line through an edge whose bright side is right: where each row's sum says that it changes sides.
/// `invalid_input`: no step between the picture's sides.
[[nodiscard]] Result<EdgeLine> first_line(const cv::Mat1d& picture);

/// Pixels within `reach` pitches of the line.
[[nodiscard]] std::vector<EdgeSample> samples_near(const cv::Mat1d& picture, const EdgeLine& line, double reach);

/// How far the profile can be followed to both sides in three rows of four, at most 32 pitches; negative where the line
/// leaves the picture.
[[nodiscard]] double reach_of(const cv::Size& size, const EdgeLine& line);

/// By how much each row's edge lies behind the line along the normal (in pitches, least squares against the profile).
[[nodiscard]] std::vector<double> row_offsets(const std::vector<EdgeSample>& samples, const Spline& profile, int rows);

/// What rows say about the line: a parabola's parts, each with its standard uncertainty.
struct RowTrend {
  double mean = 0, slope = 0;  ///< per row
  double sag = 0, sag_u = 0;   ///< middle against ends, positive towards positive offsets at the ends
};
[[nodiscard]] RowTrend trend_of(const std::vector<double>& offsets);

}  // namespace todbench
