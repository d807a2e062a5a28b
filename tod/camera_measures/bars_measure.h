// SPDX-License-Identifier: GPL-3.0-or-later
// Contrast transfer function (CTF) from the groups of bars of a plate in a mean picture.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"
#include "tod/measures/slanted_edge.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Modulations of a simulated sensor for a group, in closed form.
struct BarsModel {
  double best = 0, mean = 0, worst = 0;
};

/// CTF of one group of four bars: mean of the largest samples of the bars minus mean of the smallest samples of the
/// spaces, as bar_modulation() reads them, over the contrast of large areas.
struct BarsCtf {
  std::string group;  ///< name of the group
  EdgeAxis axis = EdgeAxis::x;
  double frequency_per_pitch = 0;    ///< across the bars, in this picture
  double angle_deg = 0;              ///< from the axis to the direction across the bars
  cv::Point2d middle_px{0, 0};       ///< centre of the group in the picture
  int pixels = 0;                    ///< used for the profile
  double noise_over_contrast = 0;    ///< of one pixel, from the residuals of the profile
  Estimate best, mean, worst;        ///< over the sampling phases
  int bars_separated_at_best = 1;    ///< 4 if every space is lower than both neighbouring bars
  double share_of_four = 0;          ///< share of the phases that show four bars
  std::optional<BarsModel> model{};  ///< empty for a real camera
};

/// CTF of all groups of a plate.
struct PlateBarsCtf {
  std::vector<BarsCtf> groups;         ///< x before y, low frequencies first
  double contrast_k = 0;               ///< of large areas, signed, in the unit of the picture
  double far_spread = 0;               ///< share of contrast_k that the optics spread beyond the squares; corrected
  std::vector<std::string> reasons{};  ///< sentences about groups that could not be measured
};

/// Measures the CTF of every group. A group is slanted, so that each line of pixels has another phase. All pixels at
/// least 3.5 pixels from its ends are samples of one profile along the normal: four bars with one common line spread, a
/// cubic spline with knots every 0.15 pitch, fitted by least squares (BarsFit). The profile is sampled once a pitch at
/// 64 phases, and best, mean and worst modulation are read from it. Phases between those of the plate are interpolated;
/// no phase depends on a single pixel.
///
/// Contrast: centre of the plate's rectangles minus the area more than 5 pixels away from every cut-out. The light that
/// the optics spread further is corrected to first order: an MTF that begins as 1 - a f spreads a / (4 pi^2 r^3) at a
/// distance r (Fourier pair), a comes from the edges of the rectangles (plate_edges()), and the sum is taken over the
/// plate's drawing. The half-width of its interval is the whole correction, because a halo spreads light differently.
/// Halos wider than the squares are a loss of contrast of squares and bars, and not part of the CTF.
///
/// Intervals: 100 repetitions with noise as large as the residual of the spline (`seed`) give standard deviation and
/// bias (the extremes of a noisy profile are too far apart). The bias is corrected and included in the interval. The
/// difference to a spline with knots every 0.2 pitch is included too.
/// `where` as for plate_edges(). Errors: `calibration` (plate not in the picture, or no contrast of its squares),
/// `invalid_input` (plate without bars or without rectangles).
[[nodiscard]] Result<PlateBarsCtf> plate_bars_ctf(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const Registration& where, std::uint64_t seed = 1);

}  // namespace todbench
