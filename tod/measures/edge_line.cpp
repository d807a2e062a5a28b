// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/edge_line.h"

#include <algorithm>
#include <cmath>

#include "tod/measures/medians.h"

namespace todbench {
namespace {

constexpr double longest_reach_pitch = 32;

}  // namespace

double EdgeLine::cosine() const {
  return 1 / std::sqrt(1 + slope * slope);
}

Result<EdgeLine> first_line(const cv::Mat1d& picture) {
  const int side = std::max(2, picture.cols / 12);
  const double dark = median_of(picture.colRange(0, side));
  const double bright = median_of(picture.colRange(picture.cols - side, picture.cols));
  if (!(bright > dark)) return fail(ErrorCode::invalid_input, "there is no edge: both sides have the same level");
  EdgeLine line;
  line.middle_row = 0.5 * (picture.rows - 1);
  double first = 0, square = 0;
  for (int row = 0; row < picture.rows; ++row) {
    // The bright share of a row of pixels, each one pitch wide, for any profile between the two sides.
    const double lit = (cv::sum(picture.row(row))[0] - picture.cols * dark) / (bright - dark);
    const double x = picture.cols - 0.5 - lit, y = row - line.middle_row;
    line.middle += x / picture.rows;
    first += x * y, square += y * y;
  }
  line.slope = first / square;
  return line;
}

std::vector<EdgeSample> samples_near(const cv::Mat1d& picture, const EdgeLine& line, double reach) {
  std::vector<EdgeSample> samples;
  const double cosine = line.cosine();
  for (int row = 0; row < picture.rows; ++row) {
    const double x0 = line.at(row);
    const int first = std::max(0, static_cast<int>(std::ceil(x0 - reach / cosine)));
    const int last = std::min(picture.cols - 1, static_cast<int>(std::floor(x0 + reach / cosine)));
    for (int x = first; x <= last; ++x) samples.push_back({(x - x0) * cosine, picture(row, x), row});
  }
  return samples;
}

double reach_of(const cv::Size& size, const EdgeLine& line) {
  std::vector<double> reaches;
  for (int row = 0; row < size.height; ++row) {
    const double x = line.at(row);
    reaches.push_back(std::min(x + 0.5, size.width - 0.5 - x) * line.cosine());
  }
  std::sort(reaches.begin(), reaches.end());
  if (reaches.front() < 0) return reaches.front();
  return std::min(reaches[reaches.size() / 4], longest_reach_pitch);
}

std::vector<double> row_offsets(const std::vector<EdgeSample>& samples, const Spline& profile, int rows) {
  std::vector<double> products(static_cast<std::size_t>(rows)), squares(products);
  for (const EdgeSample& sample : samples) {
    if (!(sample.t >= profile.grid.start && sample.t <= profile.grid.end())) continue;
    const double slope = profile.slope(sample.t);
    products[static_cast<std::size_t>(sample.row)] += (profile.value(sample.t) - sample.value) * slope;
    squares[static_cast<std::size_t>(sample.row)] += slope * slope;
  }
  std::vector<double> offsets;
  for (std::size_t row = 0; row < products.size(); ++row)
    offsets.push_back(squares[row] > 0 ? products[row] / squares[row] : 0);
  return offsets;
}

RowTrend trend_of(const std::vector<double>& offsets) {
  const double count = static_cast<double>(offsets.size()), middle = 0.5 * (count - 1);
  const double mean_square = (count * count - 1) / 12;
  double sum = 0, first = 0, first_square = 0, second = 0, second_square = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double y = static_cast<double>(i) - middle, parabola = y * y - mean_square;
    sum += offsets[i];
    first += offsets[i] * y, first_square += y * y;
    second += offsets[i] * parabola, second_square += parabola * parabola;
  }
  const double curve = second / second_square;
  RowTrend trend{sum / count, first / first_square, curve * middle * middle, 0};
  double residual = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double y = static_cast<double>(i) - middle;
    residual += std::pow(offsets[i] - trend.mean - trend.slope * y - curve * (y * y - mean_square), 2);
  }
  trend.sag_u = std::sqrt(residual / (count - 3) / second_square) * middle * middle;
  return trend;
}

}  // namespace todbench
