// SPDX-License-Identifier: GPL-3.0-or-later
// Halo of a camera: light of the triangles that the camera spreads over the plate between them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "sim_devices/prediction/camera_optics.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Halo found in the pictures.
struct CameraHalo {
  double share = 0;     ///< share of the light of a triangle, in excess of the twin's halo; negative: less than the
                        ///< twin
  double share_se = 0;  ///< standard error of `share` for a normal halo of this width
  double sigma_px = 0;  ///< standard deviation of the normal halo that fits the pictures best
};

/// Estimates a halo from several set-ups. The fit compares the brightness of the plate between the triangles, minus the
/// tail of diffraction, with the brightness that normal halos of 3 to 22 pixels (sigma) produce. The fit subtracts the
/// common part of all set-ups (fixed pattern, uneven lens or background) and a plane of every picture. Only light that
/// moves with the triangles then has an effect. A plate that is warm beside its openings cannot be distinguished from a
/// halo.
///
/// Pixels within 4 detector pitches of a triangle or of the border of the plate are not used. The standard error is the
/// largest of three estimates, clustered by blocks of 16 x 16 pixels, by rows and by columns of these blocks.
class CameraHaloFit {
 public:
  /// `samples_per_pitch`: samples of the camera per detector pitch and axis.
  CameraHaloFit(const SensorSpec& twin, int samples_per_pitch);

  /// Adds a picture with the contrast `delta_t_k`. Pictures of a different size and a contrast of 0 are ignored.
  void add(const OpticsPicture& picture, double delta_t_k);

  /// Returns the halo. `f_number_ratio`: f-number of the camera over the twin's (CameraOptics), for the tail of
  /// diffraction. Empty with fewer than two set-ups, if |share| is below 0.5 %, a fifth of the twin's share or five
  /// standard errors, or if the total is negative. White noise exceeds these limits in one of a million sessions.
  [[nodiscard]] std::optional<CameraHalo> result(double f_number_ratio) const;

 private:
  /// Means over cells of 4 x 4 pixels; zero weight where triangles are near.
  struct Look {
    cv::Mat1f level;                ///< K per K of contrast
    cv::Mat1f tail;                 ///< tail of diffraction at the twin's f-number, for contrast 1
    std::vector<cv::Mat1f> haloes;  ///< haloes of contrast 1, by sigma
    cv::Mat1f weight;
  };
  struct Estimate {
    double share = 0, share_se = 0, gain = 0;  ///< gain: decrease of chi-square by this halo
  };
  [[nodiscard]] std::optional<Estimate> estimate(std::size_t width, double f_number_ratio) const;

  double diffraction_px_ = 0;  ///< slope of the MTF at frequency 0
  double clear_px_, aspect_, twin_share_, twin_sigma_px_;
  std::vector<Look> looks_;
};

}  // namespace todbench
