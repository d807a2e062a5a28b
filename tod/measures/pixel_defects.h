// SPDX-License-Identifier: GPL-3.0-or-later
// Finds defective pixels in a cube of frames of a flat field, and pixels that the camera has substituted.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measures/bad_pixels.h"

namespace todbench {

/// Kinds of defects.
enum class PixelDefect {
  stuck,         ///< has the same value in every frame
  offset,        ///< dead or hot pixel: the deviation of the level in the flat field exceeds the limit
  unresponsive,  ///< dead pixel: the deviation of the response to temperature exceeds the limit
  noisy,
  blinking,     ///< switches between two levels, or stays on a different level for several frames
  substituted,  ///< equals a neighbour, or the mean of neighbours, in every frame, because the camera has substituted
                ///< it
};
inline constexpr std::array pixel_defect_kinds{PixelDefect::stuck, PixelDefect::offset,   PixelDefect::unresponsive,
                                               PixelDefect::noisy, PixelDefect::blinking, PixelDefect::substituted};
[[nodiscard]] std::string_view to_string(PixelDefect kind);

/// Limits of defects.
struct PixelDefectRules {
  BadPixelRules bad;  ///< dead_responsivity, noisy, offset
  /// Limit of the largest change of level in units of its standard deviation, as a multiple of the median over the
  /// pixels.
  double blinking = 3;
  /// Limit of the distance between two levels, in standard deviations of the pixel and also in standard deviations of
  /// the median pixel.
  double levels = 4.5;
  double chance = 1e-3;  ///< probability, over all pixels, that a live pixel is classified as substituted
};

/// Known properties of the scene.
struct PixelScene {
  cv::Mat1d shading{};       ///< subtracted from the mean frame before levels are compared; empty: not subtracted
  cv::Mat1d responsivity{};  ///< signal per kelvin; NaN if not measured; empty: measured for no pixel
  std::optional<double> unit_per_count{};  ///< unit of the frames per count; empty: not known
};

/// Defective pixels of a cube of frames.
struct PixelDefects {
  int frames = 0;
  std::array<cv::Mat1b, pixel_defect_kinds.size()> found;  ///< 255 for each defect, by kind
  cv::Mat1b bad;                                           ///< any kind except substituted
  cv::Mat1b defective;                                     ///< any kind
  cv::Mat1i cluster;                      ///< size of the cluster of touching pixels, also diagonally; 0: not defective
  cv::Mat1d noise_sd;                     ///< temporal noise of each pixel, without the common part of rows and columns
  cv::Mat1d mean_frame;                   ///< mean over the frames, minus the shading
  int response_tested = 0;                ///< number of pixels with a known response
  std::vector<std::string> not_tested{};  ///< sentences about kinds that cannot be detected in these frames

  [[nodiscard]] const cv::Mat1b& of(PixelDefect kind) const { return found[static_cast<std::size_t>(kind)]; }
};

/// Finds defective pixels in the frames of one cube, in order, without a correction between them. Results are in the
/// unit of the frames. Errors: `invalid_input` (fewer than 16 frames or fewer than 8 rows or columns, frames of
/// different sizes, a value that is not finite, no noise, or noise below half a count, which hides defects).
///
/// Stuck: the pixel has a single value. Tested only if fewer than 0.01 live pixels are expected to have a single value
/// by chance. Offset, response and noise: bad_pixels(). Blinking: tested with at least 48 frames, which are combined
/// into at most 64 blocks. There are two criteria. The first is the largest difference between the mean of successive
/// blocks and the mean of all other blocks, divided by its standard uncertainty from successive differences. The second
/// is the distance of two levels in the best partition of the values into two classes of at least three frames.
///
/// Substituted: the pixel nearly equals a neighbour, the mean of two to four of the nearest neighbours, or the mean of
/// all eight neighbours. The variance of the difference is then lower than `chance` permits for a live pixel. A
/// chi-square test compares this variance with that of the median pixel; for noise with memory, the number of frames is
/// reduced. If two pixels are equal, the second pixel in reading order is regarded as the copy.
[[nodiscard]] Result<PixelDefects> pixel_defects(std::span<const cv::Mat1f> frames, const PixelScene& scene,
                                                 const PixelDefectRules& rules);

/// Counts in a zone of the picture, in pixels.
struct ZoneCount {
  int pixels = 0;    ///< number of pixels of the zone inside the picture
  int measured = 0;  ///< number of these pixels that were measured
  int bad = 0, substituted = 0;
  int clusters = 0;         ///< number of clusters of at least two defective pixels that have a pixel in the zone
  int largest_cluster = 0;  ///< number of pixels, including pixels outside the zone; 1: no defective pixels touch
};
/// Counts the pixels of a zone. `zone` in pixels of the picture; `field`: examined part.
[[nodiscard]] ZoneCount count_zone(const PixelDefects& defects, const cv::Rect& field, const cv::Rect& zone);

}  // namespace todbench
