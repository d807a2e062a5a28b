// SPDX-License-Identifier: GPL-3.0-or-later
// Size-of-source effect: signal that a small source loses, and an opaque spot gains, because the camera spreads light
// far.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Signal in the middle of one aperture or opaque spot over the signal in the middle of the reference aperture.
struct SourceSizePoint {
  std::string place;   ///< name of the aperture, or of the ring round the spot
  bool spot = false;   ///< an opaque spot (inverse method); otherwise an aperture (direct method)
  double size_px = 0;  ///< side of the square
  Estimate ratio;      ///< 1 for an aperture and 0 for a spot, if no light is spread
  double fitted = 0;   ///< ratio by the fitted tails
  double model = -1;   ///< of a simulated sensor; below 0: not known
};

/// The size-of-source effect of a camera.
struct SourceSize {
  double reference_px = 0;                ///< side of the reference aperture
  double reference_k = 0;                 ///< its signal on the camera's scale
  double reference_u_k = 0;               ///< standard uncertainty by noise
  std::vector<SourceSizePoint> points{};  ///< apertures, then spots, each from small to large
  std::vector<double> size_px{};          ///< of the curve, rising from 4 to `reference_px`
  /// Signal of a square source of that side over that of the reference, with the 95 % interval of the fitted tails,
  /// which is not symmetric.
  std::vector<Estimate> ratio{};
  double chi2 = 0;             ///< of the points about the fitted tails
  int degrees_of_freedom = 0;  ///< number of points
  bool consistent = true;      ///< p of chi2 above 0.001; otherwise `ratio` contains the largest distance of a point

  /// Share of the signal that a square source of side `size_px` loses against the reference. Precondition: a curve.
  [[nodiscard]] Estimate loss(double side_px) const;
};

/// Pictures of the plate in kelvin of the camera's scale: without contrast, with contrast, without contrast again, each
/// the mean of as many frames. The mean of the outer two removes fixed pattern and a uniform drift; their difference
/// gives the noise.
struct SourcePictures {
  cv::Mat1d before, lit, after;
  /// Rise of the plate's own temperature from the outer two to the lit picture, over the contrast, both as reported by
  /// the target. A radiator heats the plate in front of it, and the signal of the whole picture rises with the plate.
  /// 0: not reported.
  double plate_rise = 0;
};

/// Locates the plate by its rectangles, takes the signal in the middle of every aperture and spot (direct and inverse
/// method), and fits the tails (plate_tails()) round the reference, the largest rectangle. The parts of a ring have
/// names "ring NAME: PART"; the middle of the ring is the spot.
///
/// Errors: `calibration` (rectangles not in the picture, a reference without signal), `invalid_input` (plate without
/// two apertures).
[[nodiscard]] Result<SourceSize> source_size(const SourcePictures& pictures, const TargetPlate& mounted_plate,
                                             const Registration& where);

}  // namespace todbench
