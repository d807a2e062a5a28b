// Counts to a picture on a screen: colour maps, level and span, histogram.
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

/// Values from low to high take the map from end to end. high > low.
struct LevelSpan {
  double low = 0, high = 1;
  [[nodiscard]] double level() const { return (low + high) / 2; }
  [[nodiscard]] double span() const { return high - low; }
};

/// From the 0.05 to the 99.95 % quantile (a few bad pixels do not count, the triangles of a plate do), at least
/// `least_span` wide: noise alone does not fill the map.
[[nodiscard]] LevelSpan automatic_level(const cv::Mat1w& counts, double least_span);

/// Marks over a picture.
struct PictureMarks {
  int saturated_from = -1;  ///< counts from here on, and counts of 0, are marked; < 0: none are
};

[[nodiscard]] QImage to_image(const cv::Mat1w& counts, const LevelSpan& level, ColourMap map, PictureMarks marks);
/// The same for values of any unit, without marks.
[[nodiscard]] QImage to_image(const cv::Mat1d& values, const LevelSpan& level, ColourMap map);

/// Pixels per bin between the ends of `level`; those outside are in the first and last bin.
[[nodiscard]] std::vector<int> histogram(const cv::Mat1w& counts, const LevelSpan& level, int bins);

/// Pixels that are stuck: more than `limit_counts` from the median of their eight neighbours, of which none shares in
/// it by a twentieth.
[[nodiscard]] std::vector<cv::Point> dead_pixels(const cv::Mat1w& counts, double limit_counts);

}  // namespace todbench
