// SPDX-License-Identifier: GPL-3.0-or-later
// Converts counts to a picture on a screen: colour maps, level and span, histogram.
#pragma once

#include <QImage>
#include <QString>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace todbench {

enum class ColourMap { white_hot, black_hot, iron, viridis };
inline constexpr std::array all_colour_maps{ColourMap::white_hot, ColourMap::black_hot, ColourMap::iron,
                                            ColourMap::viridis};
[[nodiscard]] QString name_of(ColourMap map);

/// Range of values mapped to the whole colour map. high > low.
struct LevelSpan {
  double low = 0, high = 1;
  [[nodiscard]] double level() const { return (low + high) / 2; }
  [[nodiscard]] double span() const { return high - low; }
};

/// Returns the range from the 0.05 to the 99.95 % quantile (ignores a few bad pixels, keeps the triangles of a plate).
/// It is at least `least_span` wide, so that noise alone does not fill the map.
[[nodiscard]] LevelSpan automatic_level(const cv::Mat1w& counts, double least_span);

/// Marks over a picture.
struct PictureMarks {
  int saturated_from = -1;  ///< marks counts from here on, and counts of 0; < 0: no marks
};

[[nodiscard]] QImage to_image(const cv::Mat1w& counts, const LevelSpan& level, ColourMap map, PictureMarks marks);
/// The same for values of any unit, without marks.
[[nodiscard]] QImage to_image(const cv::Mat1d& values, const LevelSpan& level, ColourMap map);

/// Returns grey levels as they are, one pixel for each.
[[nodiscard]] QImage grey_image(const cv::Mat1b& levels);

/// Pixels per bin between the ends of `level`; values outside fall into the first and last bin.
[[nodiscard]] std::vector<int> histogram(const cv::Mat1w& counts, const LevelSpan& level, int bins);

/// Returns stuck pixels: those that differ by more than `limit_counts` from the median of their eight neighbours, if no
/// neighbour differs by a twentieth of that.
[[nodiscard]] std::vector<cv::Point> dead_pixels(const cv::Mat1w& counts, double limit_counts);

}  // namespace todbench
