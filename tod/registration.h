// Where the plate is in the picture.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/core/result.h"
#include "tod/target_plate.h"

namespace todbench {

struct RegistrationOptions {
  double expected_scale_px_per_mm = 0;  ///< from distance and IFOV of the plan, > 0
  double max_scale_deviation = 0.02;    ///< relative; beyond it plan and picture contradict each other
  double max_rotation_deg = 10;
  double max_residual_px = 0.25;  ///< rms over the triangles used
  double min_triangle_px = 3.5;   ///< size (square root of area) from which a triangle is located by itself
  int min_triangles = 6;
};

/// The mapping from plate to pixels with its quality. Pixel (column, row) has its centre at the integer position.
struct Registration {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();  ///< mm on the mounted plate -> pixels
  double residual_px = 0;                           ///< rms distance between located and mapped centroids
  int triangles_used = 0;
  double scale_px_per_mm = 0;  ///< square root of the area magnification at the middle of the plate
  double rotation_deg = 0;     ///< clockwise in the picture
  double scale_deviation = 0;  ///< relative to the expected scale
  double contrast_sign = 1;    ///< +1: triangles warmer than their surround

  /// Pixel position of a place on the mounted plate.
  [[nodiscard]] cv::Point2d pixel(cv::Point2d plate_mm) const;
  /// Pixels per millimetre (square root of the area magnification) at a place.
  [[nodiscard]] double scale_at(cv::Point2d plate_mm) const;
  /// The same registration for a plate moved by `shift_mm` in its own plane.
  [[nodiscard]] Registration shifted(cv::Point2d shift_mm) const;
  /// The same registration with everything moved by `shift_px` in the picture.
  [[nodiscard]] Registration moved(cv::Point2d shift_px) const;
};

/// Finds a mounted plate in an averaged high-contrast picture (kelvin or counts). Small triangles are never located by
/// themselves. `calibration` with a reason when the plate is not found, the scale contradicts the expected one, the
/// residual is too large, or the large triangles do not point where the mounted plate says (a plate in another mounting
/// than stated).
[[nodiscard]] Result<Registration> register_plate(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const RegistrationOptions& options);

/// Movement of the picture, in pixels, since `registration`: for benches on which a hand or an unknown drift moves the
/// plate. Uses the large triangles of an averaged picture at any contrast that shows them. `calibration` when they
/// cannot be found within `search_px`.
[[nodiscard]] Result<cv::Point2d> measure_shift(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                const Registration& registration, const RegistrationOptions& options,
                                                double search_px);

/// Effective contrast in the unit of the picture: over the triangles of at least `min_size_px`, median of the inside
/// minus median of the surround, the mean over triangles; sign included. Its standard error is over triangles.
struct EffectiveContrast {
  double value = 0;
  double standard_error = 0;
  int triangles = 0;
};
[[nodiscard]] Result<EffectiveContrast> effective_contrast(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                           const Registration& registration, double min_size_px);

}  // namespace todbench
