// SPDX-License-Identifier: GPL-3.0-or-later
// Blur of a camera, estimated from the large triangles of its own pictures with the optics of its twin as the model.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "hvs/shape/polygon.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// An averaged picture of one set-up, at rest.
struct OpticsPicture {
  const cv::Mat1d& picture;  ///< kelvin
  const TargetPlate& mounted_plate;
  const Registration& registration;
  double min_size_px = 4;       ///< smallest triangles that are fitted
  double averaged_noise_k = 0;  ///< temporal noise of a pixel of the average; 0: unknown
};

/// Optics estimated from the pictures, relative to a sensor file.
struct CameraOptics {
  double aberration_sigma_pitch = 0;
  double f_number_ratio = 1;  ///< f-number of the camera divided by the f-number of the sensor file
  double aberration_se_pitch = 0, f_number_ratio_se = 0;
  /// Chi-square of the optics of the sensor file minus the smallest chi-square. For a camera equal to the sensor file
  /// this difference has two degrees of freedom.
  double twin_statistic = 0;
  double chi2 = 0;  ///< smallest chi-square per degree of freedom, relative to the noise of the plate
  double chi2_limit = 1;
  double degrees_of_freedom = 0;
  double noise_k = 0;          ///< noise of a pixel of the average, measured on the plate between the triangles
  double fixed_pattern_k = 0;  ///< part of noise_k that averaging does not explain
  double fixed_pattern_variance_se_k2 = 0;
  int pictures = 0;

  /// Returns whether the model describes the pictures.
  [[nodiscard]] bool fits() const { return chi2 <= chi2_limit; }
  /// Returns whether the optics differ from the sensor file at the significance level `probability`.
  [[nodiscard]] bool differs(double probability) const;
};

/// Joint least squares over all pictures. The parameters of the camera are aberration (Gaussian sigma >= 0) and
/// f-number ratio (0.45 to 2.2). The parameters of every large triangle are amplitude, background plane and shift. The
/// model is the optics and the detector of the twin at the sampling of the camera. The fit uses pixels inside a
/// triangle and up to 3 px outside. Pixels with residuals above 8 standard deviations are left out if they are few.
///
/// The noise is measured on the plate between the triangles and includes fixed pattern and rounding. chi2_limit is 1
/// plus four standard deviations, from the scatter of that noise over blocks of the plate. Errors of the renderer count
/// as noise of 1e-4 of the contrast, which is twice the residual of pictures without noise.
///
/// For every picture, chi-square is approximated by a parabola in the squared aberration sigma and the f-number ratio.
/// The calculation takes a tenth of a second per picture. Not thread-safe.
class CameraOpticsFit {
 public:
  /// `samples_per_pitch`: of the camera. `wavelengths`: as in Accuracy, 16 for a real camera. Precondition:
  /// validate(twin) succeeds.
  CameraOpticsFit(const SensorSpec& twin, int samples_per_pitch, int wavelengths = 16);

  /// Returns whether the model covers this sensor, which must have no display, distortion, super-resolution or module.
  [[nodiscard]] static bool models(const SensorSpec& twin);

  /// Adds a picture. Returns false if the picture has no large triangle with free surround, or if its fit does not
  /// converge.
  bool add(const OpticsPicture& picture);

  /// Returns the estimate; empty before the first picture.
  [[nodiscard]] std::optional<CameraOptics> result() const;

 private:
  /// Sigma squared (pitch^2) and f-number ratio.
  using Theta = cv::Vec2d;
  struct Parabola {
    Theta at;
    cv::Matx22d curvature;  ///< curvature of chi-square / 2
    cv::Vec2d slope;
    double chi2 = 0, freedom = 0;
    int windows = 0;
  };
  struct Noise {
    double variance = 0, scatter = 0, temporal_variance = 0;  ///< scatter: of the variance of one block, relative
    int blocks = 0;
  };

  [[nodiscard]] static Noise noise_of(const OpticsPicture& picture, const std::vector<Polygon>& outlines);
  [[nodiscard]] std::optional<Parabola> parabola(const OpticsPicture& picture, const std::vector<Polygon>& outlines,
                                                 double noise_variance) const;
  [[nodiscard]] Theta joint(const Parabola* another) const;

  SensorSpec twin_;
  SensorPlan plan_;
  int samples_per_pitch_, wavelengths_;
  Theta of_twin_;
  std::vector<Parabola> parabolas_;
  std::vector<Noise> noises_;
};

}  // namespace todbench
