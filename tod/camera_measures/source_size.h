// SPDX-License-Identifier: GPL-3.0-or-later
// Size-of-source effect. The camera spreads light over large distances, so a small source loses signal and an opaque
// spot gains signal.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Signal in the middle of an aperture or opaque spot, divided by the signal in the middle of the reference aperture.
struct SourceSizePoint {
  std::string place;   ///< name of the aperture, or of the ring round the spot
  bool spot = false;   ///< an opaque spot (inverse method); otherwise an aperture (direct method)
  double size_px = 0;  ///< side of the square
  Estimate ratio;      ///< ratio of these signals; without spread of light it is 1 for an aperture and 0 for a spot
  double fitted = 0;   ///< ratio according to the fitted tails
  double model = -1;   ///< ratio for a simulated sensor; negative: not known
};

/// The size-of-source effect of a camera.
struct SourceSize {
  double reference_px = 0;                ///< side of the reference aperture
  double reference_k = 0;                 ///< signal of the reference aperture on the camera's scale
  double reference_u_k = 0;               ///< standard uncertainty due to noise
  std::vector<SourceSizePoint> points{};  ///< apertures, then spots, each from small to large
  std::vector<double> size_px{};          ///< sides of the curve, increasing from 4 to `reference_px`
  /// For each side of `size_px`, signal of the square source divided by the signal of the reference. The 95 % interval
  /// is that of the fitted tails and is not symmetric.
  std::vector<Estimate> ratio{};
  double chi2 = 0;             ///< chi-square of the points relative to the fitted tails
  int degrees_of_freedom = 0;  ///< number of points
  /// True: the p value of chi2 is above 0.001. False: the interval of `ratio` includes the largest deviation of a
  /// point.
  bool consistent = true;

  /// Returns the share of the signal that a square source of side `side_px` loses relative to the reference.
  /// Precondition: `ratio` is not empty.
  [[nodiscard]] Estimate loss(double side_px) const;
};

/// Pictures of the plate in kelvin of the camera's scale: without contrast, with contrast, and again without contrast.
/// Each picture is the mean of the same number of frames. The mean of `before` and `after` is subtracted to remove
/// fixed pattern and uniform drift. The difference of `before` and `after` determines the noise.
struct SourcePictures {
  cv::Mat1d before, lit, after;
  /// Temperature of the plate at `lit` minus its mean at `before` and `after`, divided by the contrast. Temperature and
  /// contrast are those that the target reports. The radiator heats the plate, which increases the signal of the whole
  /// picture. 0: not reported.
  double plate_rise = 0;
};

/// Locates the plate by its rectangles and measures the signal in the middle of every aperture and spot (direct and
/// inverse method). Fits the tails (plate_tails()) round the reference, which is the largest rectangle. Rectangles with
/// names of the form "ring NAME: PART" are the parts of a ring; the middle of the ring is a spot.
///
/// Errors: `calibration` (rectangles not in the picture, a reference without signal), `invalid_input` (plate without
/// two apertures).
[[nodiscard]] Result<SourceSize> source_size(const SourcePictures& pictures, const TargetPlate& mounted_plate,
                                             const Registration& where);

}  // namespace todbench
