// Pixels of a cube of frames of a flat field that do not answer like the others, and those that a camera has replaced.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/measures/bad_pixels.h"

namespace todbench {

enum class PixelDefect {
  stuck,         ///< the same value in every frame
  offset,        ///< dead or hot by its level before the flat field
  unresponsive,  ///< dead by its response to temperature
  noisy,
  blinking,     ///< sits on two levels, or on another one for a stretch of frames
  substituted,  ///< equals a neighbour, or the mean of neighbours, in every frame: replaced by the camera
};
inline constexpr std::array pixel_defect_kinds{PixelDefect::stuck, PixelDefect::offset,   PixelDefect::unresponsive,
                                               PixelDefect::noisy, PixelDefect::blinking, PixelDefect::substituted};
[[nodiscard]] std::string_view to_string(PixelDefect kind);

struct PixelDefectRules {
  BadPixelRules bad;     ///< dead_responsivity, noisy, offset
  double blinking = 3;   ///< largest change of level, in its own standard deviations, above so many medians of it
  double levels = 4.5;   ///< or two levels so many standard deviations apart, both its own and the median pixel's
  double chance = 1e-3;  ///< how often, of all pixels together, one that is live would be taken for substituted
};

/// What is known beside the frames.
struct PixelScene {
  cv::Mat1d shading{};       ///< taken out of the mean frame before levels are compared; empty: none
  cv::Mat1d responsivity{};  ///< signal per kelvin; not a number where it was not measured; empty: nowhere
  std::optional<double> unit_per_count{};  ///< of the frames; nothing: not known
};

struct PixelDefects {
  int frames = 0;
  std::array<cv::Mat1b, pixel_defect_kinds.size()> found;  ///< by kind: 255 where it is one
  cv::Mat1b bad;                                           ///< any kind but substituted
  cv::Mat1b defective;                                     ///< any kind
  cv::Mat1i cluster;                      ///< of pixels that touch, diagonally too: its size; 0: not defective
  cv::Mat1d noise_sd;                     ///< temporal, without what rows and columns have in common
  cv::Mat1d mean_frame;                   ///< without the shading
  int response_tested = 0;                ///< pixels whose response is known
  std::vector<std::string> not_tested{};  ///< sentences: kinds that these frames cannot show

  [[nodiscard]] const cv::Mat1b& of(PixelDefect kind) const { return found[static_cast<std::size_t>(kind)]; }
};

/// Frames of one cube, in order, with no correction between them. In the unit of the frames. `invalid_input`: fewer
/// than 16 frames or than 8 rows or columns, frames of different sizes, a value that is not finite, no noise, or a
/// noise below half a count, which hides what is looked for.
///
/// Stuck: no value but one; tested where chance would leave less than 0.01 live pixels so. Offset, response and noise:
/// bad_pixels(). Blinking: with the frames in at most 64 stretches, the largest difference of the mean of some of them
/// in a row from that of the others, over its standard uncertainty from successive differences; or the best parting of
/// the values into two classes of at least three frames. From 48 frames on.
///
/// Substituted: the difference from a neighbour, or from the mean of two to four of the nearest or of all eight, has
/// less variance than `chance` allows a live pixel (chi-squared, against the median pixel's difference, frames that
/// remember counted as fewer). Of two that are equal one is the copy: the later one in reading order is taken for it.
[[nodiscard]] Result<PixelDefects> pixel_defects(std::span<const cv::Mat1f> frames, const PixelScene& scene,
                                                 const PixelDefectRules& rules);

/// A part of the picture with its limits, in pixels.
struct ZoneCount {
  int pixels = 0;    ///< of the zone in the picture
  int measured = 0;  ///< of these
  int bad = 0, substituted = 0;
  int clusters = 0;         ///< of two defective pixels or more that have a pixel in the zone
  int largest_cluster = 0;  ///< pixels of the largest, also those beyond the zone; 1: none touch
};
/// `zone` in the pixels of the picture; `field` is where the defects were looked for.
[[nodiscard]] ZoneCount count_zone(const PixelDefects& defects, const cv::Rect& field, const cv::Rect& zone);

}  // namespace todbench
