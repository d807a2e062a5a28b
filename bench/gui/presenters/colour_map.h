// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of counts to a picture on a screen: colour maps, level and span, histogram.
#pragma once

#include <QImage>
#include <QString>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace todbench {

/// Colours of a picture.
enum class ColourMap { white_hot, black_hot, iron, viridis };
inline constexpr std::array all_colour_maps{ColourMap::white_hot, ColourMap::black_hot, ColourMap::iron,
                                            ColourMap::viridis};
/// Returns the label of the colour map.
[[nodiscard]] QString name_of(ColourMap map);

/// Range of values mapped to the whole colour map. high > low.
struct LevelSpan {
  double low = 0, high = 1;
  /// Returns the middle of the range.
  [[nodiscard]] double level() const { return (low + high) / 2; }
  /// Returns the width of the range.
  [[nodiscard]] double span() const { return high - low; }
};

/// Returns the range from the 0.05 % to the 99.95 % quantile. This range ignores a few bad pixels and contains the
/// triangles of a plate. Its width is at least `least_span` counts, so that noise alone does not fill the map.
[[nodiscard]] LevelSpan automatic_level(const cv::Mat1w& counts, double least_span);

/// Marks over a picture.
struct PictureMarks {
  int saturated_from = -1;  ///< marks counts of this value or more, and counts of 0; < 0: no marks
};

/// Returns the counts as a picture in the colours of `map`, with marks.
[[nodiscard]] QImage to_image(const cv::Mat1w& counts, const LevelSpan& level, ColourMap map, PictureMarks marks);
/// Returns values of any unit as a picture, without marks.
[[nodiscard]] QImage to_image(const cv::Mat1d& values, const LevelSpan& level, ColourMap map);

/// Returns grey levels unchanged, one pixel for each level.
[[nodiscard]] QImage grey_image(const cv::Mat1b& levels);

/// Returns the number of pixels per bin between the limits of `level`; values outside are counted in the first and last
/// bin.
[[nodiscard]] std::vector<int> histogram(const cv::Mat1w& counts, const LevelSpan& level, int bins);

/// Returns stuck pixels. A stuck pixel differs by more than `limit_counts` from the median of its eight neighbours, and
/// every neighbour differs from this median by less than a twentieth of that difference.
[[nodiscard]] std::vector<cv::Point> dead_pixels(const cv::Mat1w& counts, double limit_counts);

}  // namespace todbench
