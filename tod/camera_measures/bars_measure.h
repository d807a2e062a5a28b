// Contrast transfer (CTF) from the groups of bars of a plate in a mean picture.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/measures/slanted_edge.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// A modulation with its 95 % interval.
struct Modulation {
  double value = 0, low = 0, high = 0;
};

/// The closed form of a simulated sensor for a group.
struct BarsModel {
  double best = 0, mean = 0, worst = 0;
};

/// What is left of one group of four bars: mean of the largest samples of the bars less mean of the smallest of the
/// spaces, as bar_modulation() reads them, over the contrast of large areas.
struct BarsCtf {
  std::string group;  ///< its name
  EdgeAxis axis = EdgeAxis::x;
  double frequency_per_pitch = 0;    ///< across the bars, in this picture
  double angle_deg = 0;              ///< of the direction across the bars to the axis
  cv::Point2d middle_px{0, 0};       ///< where it was found
  int pixels = 0;                    ///< that were used
  double noise_over_contrast = 0;    ///< of a pixel, from what the profile leaves
  Modulation best, mean, worst;      ///< over the sampling phases
  int bars_separated_at_best = 1;    ///< 4 where every space is lower than both neighbours
  double share_of_four = 0;          ///< of the phases: with four bars
  std::optional<BarsModel> model{};  ///< nothing for a camera
};

struct PlateBarsCtf {
  std::vector<BarsCtf> groups;         ///< x before y, low frequencies first
  double contrast_k = 0;               ///< of large areas, in the unit of the picture, with its sign
  double far_spread = 0;               ///< share of it that the optics spread too far for the squares; corrected
  std::vector<std::string> reasons{};  ///< sentences: groups that could not be measured
};

/// A group is slanted, so that each line of pixels meets it at another phase. All pixels that stay clear of its ends by
/// 3.5 are samples of one profile over the place along the normal: four bars behind one line spread, which is a cubic
/// spline with knots every 0.15 pitch, by least squares (BarsFit). The profile is then sampled once a pitch at 64
/// phases, and best, mean and worst modulation are read from it: phases between those of the plate are interpolated,
/// none is guessed from one pixel.
///
/// Contrast: middle of the rectangles of the plate less what is more than 5 pixels away from every cut-out. What the
/// optics spread beyond is corrected to first order: an MTF that begins as 1 - a f spreads a / (4 pi^2 r^3) far away
/// (Fourier pair), a comes from the edges of the rectangles (plate_edges()), the sum goes over the plate's drawing.
/// Half of the correction is the uncertainty of it.
///
/// Intervals: 100 repetitions with noise as large as the residual of the spline (`seed`) give standard deviation and
/// bias, for the extremes of a noisy profile are too far apart; the bias is taken out and in the interval.
/// What knots every 0.2 pitch say otherwise is in the interval as it is.
/// `where` as plate_edges(). `calibration` where the plate is not in the picture or its squares give no contrast,
/// `invalid_input` for a plate without bars or without rectangles.
[[nodiscard]] Result<PlateBarsCtf> plate_bars_ctf(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const Registration& where, std::uint64_t seed = 1);

}  // namespace todbench
