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

/// Modulations of a group for a simulated sensor, in closed form.
struct BarsModel {
  double best = 0, mean = 0, worst = 0;
};

/// CTF of one group of four bars: the modulation of the bars (bar_modulation()) divided by the contrast of large areas.
/// The modulation is the mean of the largest samples of the bars minus the mean of the smallest samples of the spaces.
struct BarsCtf {
  std::string group;  ///< name of the group
  EdgeAxis axis = EdgeAxis::x;
  double frequency_per_pitch = 0;    ///< across the bars, in this picture
  double angle_deg = 0;              ///< angle from the axis to the direction across the bars
  cv::Point2d middle_px{0, 0};       ///< centre of the group in the picture
  int pixels = 0;                    ///< number of pixels used for the profile
  double noise_over_contrast = 0;    ///< noise of one pixel divided by the contrast, from the residuals of the profile
  Estimate best, mean, worst;        ///< over the sampling phases
  int bars_separated_at_best = 1;    ///< 4 if every space is lower than both neighbouring bars
  double share_of_four = 0;          ///< share of the phases at which four bars are separated
  std::optional<BarsModel> model{};  ///< modulations of a simulated sensor; empty for a real camera
};

/// CTF of all groups of a plate.
struct PlateBarsCtf {
  std::vector<BarsCtf> groups;  ///< x before y, low frequencies first
  double contrast_k = 0;        ///< contrast of large areas, signed, in the unit of the picture
  /// Share of contrast_k that the optics spread beyond the squares; contrast_k is corrected for it.
  double far_spread = 0;
  std::vector<std::string> reasons{};  ///< sentences about groups that could not be measured
};

/// Measures the CTF of every group. A group is slanted, so each line of pixels has a different sampling phase. All
/// pixels that are at least 3.5 pixels from the ends of the bars are samples of one profile along the normal. The
/// profile consists of four bars with a common line spread: a cubic spline with knots every 0.15 pitch, fitted by least
/// squares (BarsFit). The fitted profile is sampled once per pitch at 64 phases. Best, mean and worst modulation are
/// computed from these samples. Phases that do not occur on the plate are interpolated. No phase depends on a single
/// pixel.
///
/// The contrast is the signal in the centres of the plate's rectangles minus the signal of the area that is more than 5
/// pixels away from every cut-out. The contrast is corrected to first order for light that the optics spread farther:
/// optics with an MTF of 1 - a f at low frequencies f spread a / (4 pi^2 r^3) to a distance r. The value a is measured
/// at the edges of the rectangles (plate_edges()), and the spread light is summed over the drawing of the plate. The
/// half-width of the interval equals the correction itself, because a halo may spread light differently from this law.
/// Halos wider than the squares reduce the contrast of squares and bars equally and are not part of the CTF.
///
/// Standard deviation and bias are computed from 100 repetitions with simulated noise (`seed`) as large as the residual
/// of the spline. The bias arises because the extremes of a noisy profile are too far apart. The result is corrected
/// for this bias. The interval includes the bias and the difference from a spline with knots every 0.2 pitch. `where`
/// as for plate_edges(). Errors: `calibration` (plate not in the picture, or its squares have no contrast),
/// `invalid_input` (plate without bars or without rectangles).
[[nodiscard]] Result<PlateBarsCtf> plate_bars_ctf(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const Registration& where, std::uint64_t seed = 1);

}  // namespace todbench
