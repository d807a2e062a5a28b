// Where the plate is in the picture.
#pragma once

#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/plate/target_plate.h"

namespace todbench {

struct RegistrationOptions {
  double expected_scale_px_per_mm = 0;  ///< from distance and IFOV of the plan, > 0
  double max_scale_deviation = 0.02;    ///< relative; beyond it plan and picture contradict each other
  double max_rotation_deg = 10;
  double max_residual_px = 0.25;  ///< rms over the triangles used
  double min_triangle_px = 2.5;   ///< size (square root of area) from which a triangle is located by itself
  int min_triangles = 6;          ///< 1 is allowed for a plate of one triangle: then only its place is measured
};

/// How the plate is mapped to the picture, from simple to general. A more general one is taken only when the located
/// centroids demand it (F test at 1 %): a camera that looks straight at a plate needs four parameters, and each further
/// one enlarges the error of prediction.
enum class PlateMapping { translation, similarity, affine, homography };
[[nodiscard]] std::string_view to_string(PlateMapping mapping);

/// The mapping from plate to pixels with its quality. Pixel (column, row) has its centre at the integer position.
struct Registration {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();  ///< mm on the mounted plate -> pixels
  double residual_px = 0;                           ///< rms distance between located and mapped centroids
  int triangles_used = 0;
  double scale_px_per_mm = 0;  ///< square root of the area magnification at the middle of the plate
  double rotation_deg = 0;     ///< clockwise in the picture
  double scale_deviation = 0;  ///< relative to the expected scale
  double contrast_sign = 1;    ///< +1: triangles warmer than their surround
  double blur_px = 0.45;       ///< standard deviation of the Gaussian that describes the edges of the triangles best
  PlateMapping mapping = PlateMapping::similarity;

  /// Pixel position of a place on the mounted plate.
  [[nodiscard]] cv::Point2d pixel(cv::Point2d plate_mm) const;
  /// Pixels per millimetre (square root of the area magnification) at a place.
  [[nodiscard]] double scale_at(cv::Point2d plate_mm) const;
  /// The same registration for a plate moved by `shift_mm` in its own plane.
  [[nodiscard]] Registration shifted(cv::Point2d shift_mm) const;
  /// The same registration with everything moved by `shift_px` in the picture.
  [[nodiscard]] Registration moved(cv::Point2d shift_px) const;
};

/// Finds a mounted plate in an averaged high-contrast picture (kelvin or counts, either sign). Small triangles are
/// never located by themselves. Scale may differ by 30 % and rotation by 10 degrees more than the limits: that is
/// reported as a contradiction. `calibration` with a reason when the plate is not found or partly out of the picture,
/// scale or rotation contradict the expected ones, the residual is too large, or the large triangles do not point where
/// the mounted plate says (a plate in another mounting than stated). `invalid_input` when the options or the plate make
/// registration impossible or the picture is not finite.
[[nodiscard]] Result<Registration> register_plate(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const RegistrationOptions& options);

/// Movement of the picture, in pixels, since `registration`: for benches on which a hand or an unknown drift moves the
/// plate. Uses the large triangles of an averaged picture at any contrast of either sign that shows them. `calibration`
/// when they cannot be found within `search_px` in x and y.
[[nodiscard]] Result<cv::Point2d> measure_shift(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                const Registration& registration, const RegistrationOptions& options,
                                                double search_px);

/// What the level of an area is.
enum class LevelEstimate {
  median,  ///< does not care for a bad pixel or one on an edge
  mean,    ///< for pictures of a few whole levels, between which a median cannot tell; pixels that are off by half the
           ///< contrast and eight standard deviations of the ring are left out
};

/// One triangle that a contrast is measured by.
struct ReferenceTriangle {
  double value = 0;      ///< its contrast
  cv::Point2d place_px;  ///< its centroid
  double size_px = 0;
};

/// Contrast as the camera shows it, in the unit of the picture, sign included.
struct EffectiveContrast {
  double value = 0;           ///< mean over the triangles used
  double standard_error = 0;  ///< from the scatter over triangles; with one triangle from the scatter of its pixels
  int triangles = 0;
  std::vector<ReferenceTriangle> references;  ///< those
};

/// Over the triangles of at least `min_size_px`: median of the inside (0.45 of the inscribed radius, at most 1.25 px,
/// away from the edge) minus median of a ring 3 px wide that begins 1.5 px outside; means where `level` says so.
///
/// Blur makes it too small, mostly in the corners: for a total blur of 0.40 px (standard deviation, box included) by
/// 0.4 % at 4 px, 0.04 % at 5 px and less than 0.01 % from 6 px, each the mean over sampling phases. A caller who knows
/// the blur divides by the same measure of a simulated picture.
/// `invalid_input` when no triangle is that large, `calibration` when one leaves the picture.
[[nodiscard]] Result<EffectiveContrast> effective_contrast(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                           const Registration& registration, double min_size_px,
                                                           LevelEstimate level = LevelEstimate::median);

}  // namespace todbench
