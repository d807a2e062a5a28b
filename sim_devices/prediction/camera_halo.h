// SPDX-License-Identifier: GPL-3.0-or-later
// Light of the triangles that a camera spreads over the plate between them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "sim_devices/prediction/camera_optics.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// A halo that the pictures show.
struct CameraHalo {
  double share = 0;     ///< of the light of a triangle, beyond the halo of the twin; negative: less
  double share_se = 0;  ///< for a normal halo of this width
  double sigma_px = 0;  ///< the width that describes the pictures best
};

/// Estimates a halo from several set-ups: the brightness of the plate between the triangles, minus the tail of
/// diffraction, is compared with that of pictures spread by normal halos of 3 to 22 pixels. What the set-ups have in
/// common (fixed pattern, uneven lens or background) and a plane of every picture are taken out, so that only light
/// that moves with the triangles counts. A plate that is warm beside its openings looks the same.
///
/// Pixels nearer to a triangle than 4 pitches of the detector are the concern of CameraOpticsFit. The standard error is
/// the largest of three: from blocks of 16 x 16 pixels over all pictures, and from their rows and columns.
class CameraHaloFit {
 public:
  /// `samples_per_pitch`: of the camera.
  CameraHaloFit(const SensorSpec& twin, int samples_per_pitch);

  /// Adds a picture of this contrast. Pictures of another size are left out.
  void add(const OpticsPicture& picture, double delta_t_k);

  /// `f_number_ratio`: of the camera to the twin (CameraOptics), for the tail of diffraction. Empty without a halo of
  /// at least half a per cent at five standard errors: by chance in one of a million sessions with white noise. Empty,
  /// too, for fewer than two different set-ups.
  [[nodiscard]] std::optional<CameraHalo> result(double f_number_ratio) const;

 private:
  /// Means over cells of 4 x 4 pixels; zero weight where triangles are near.
  struct Look {
    cv::Mat1f level;                ///< K per K of contrast
    cv::Mat1f tail;                 ///< of diffraction, by the twin's optics
    std::vector<cv::Mat1f> haloes;  ///< of contrast 1, by width
    cv::Mat1f weight;
  };
  struct Estimate {
    double share = 0, share_se = 0, gain = 0;  ///< gain: of chi-square
  };
  [[nodiscard]] std::optional<Estimate> estimate(std::size_t width, double f_number_ratio) const;

  double diffraction_px_ = 0;  ///< slope of the MTF at frequency 0
  double clear_px_, aspect_, twin_share_, twin_sigma_px_;
  std::vector<Look> looks_;
};

}  // namespace todbench
