// SPDX-License-Identifier: GPL-3.0-or-later
// Location of the plate in the picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/shape/polygon.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Options of register_plate().
struct RegistrationOptions {
  double expected_scale_px_per_mm = 0;  ///< along x, from distance and IFOV of the plan, > 0
  double pixel_aspect = 1;              ///< expected height of a pixel over its width
  /// Largest permitted relative deviation of the scale. If the deviation is larger, plan and picture contradict each
  /// other.
  double max_scale_deviation = 0.02;
  double max_rotation_deg = 10;
  /// Largest permitted relative difference between `pixel_aspect` and the ratio of the scales along x and y. The
  /// templates of the observer are computed for `pixel_aspect`. Within this limit the acuity at the mean scale changes
  /// by less than 0.5 % (docs/validation/measurement.md).
  double max_stretch = 0.04;
  double max_residual_px = 0.25;  ///< rms over the triangles used
  double min_triangle_px = 2.5;   ///< smallest size (square root of area) of a triangle that is located separately
  /// Smallest number of located triangles. For a plate with one triangle, 1 is allowed; only the position is then
  /// measured.
  int min_triangles = 6;
};

/// Mapping of the plate to the picture, from simple to general. A more general mapping is used only if the located
/// centroids require it (F test at 1 %). Four parameters (similarity) are sufficient if the camera views the plate
/// perpendicularly. Each additional parameter increases the error of predicted positions.
enum class PlateMapping { translation, similarity, affine, homography };
[[nodiscard]] std::string_view to_string(PlateMapping mapping);

/// Mapping from plate to pixels with its quality. Pixel (column, row) has its centre at the integer position.
struct Registration {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();  ///< mm on the mounted plate -> pixels
  double residual_px = 0;                           ///< rms distance between located and mapped centroids
  int triangles_used = 0;
  double scale_px_per_mm = 0;  ///< scale along x in the middle of the plate, as scale_at()
  double pixel_aspect = 1;     ///< aspect stated in the options
  double rotation_deg = 0;     ///< clockwise in the picture
  double scale_deviation = 0;  ///< relative deviation from the expected scale
  double contrast_sign = 1;    ///< +1: triangles warmer than their surround
  double blur_px = 0.45;       ///< standard deviation of the Gaussian that best fits the edges of the triangles
  PlateMapping mapping = PlateMapping::similarity;

  /// Returns the pixel position of a point on the mounted plate.
  [[nodiscard]] cv::Point2d pixel(cv::Point2d plate_mm) const;
  /// Returns the pixels per millimetre along x at a point: sqrt(m a), where m is the area magnification and a the
  /// aspect of a pixel.
  [[nodiscard]] double scale_at(cv::Point2d plate_mm) const;
  /// Returns the same registration for a plate that is moved by `shift_mm` in its own plane.
  [[nodiscard]] Registration shifted(cv::Point2d shift_mm) const;
  /// Returns the same registration moved by `shift_px` in the picture.
  [[nodiscard]] Registration moved(cv::Point2d shift_px) const;
};

/// Locates a mounted plate in an averaged picture at a large contrast of either sign, in kelvin or counts. Small
/// triangles are never located separately. The search covers scales within 30 % of the expected scale and 10 degrees of
/// rotation beyond the limit, because a wrong scale or rotation must be reported. Errors: `calibration` with a reason
/// (plate not found or partly outside the picture; unexpected scale or rotation; unequal scales; residual too large;
/// large triangles with directions that differ from the stated directions, because the plate has a different mounting);
/// `invalid_input` (options or plate that make registration impossible, or a picture that is not finite).
[[nodiscard]] Result<Registration> register_plate(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const RegistrationOptions& options);

/// Returns the outlines, in pixels of the picture, of the triangles of at least `smallest_px`.
[[nodiscard]] std::vector<Polygon> large_outlines(const TargetPlate& mounted_plate, const Registration& registration,
                                                  double smallest_px);

/// Measures the motion of the picture since `registration`, in pixels. Use it if a person or an unknown drift moves the
/// plate. The function locates the large triangles in the averaged picture, which must be visible, with either sign of
/// the contrast. Error: `calibration` if the triangles are not found within `search_px` in x and y.
[[nodiscard]] Result<cv::Point2d> measure_shift(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                const Registration& registration, const RegistrationOptions& options,
                                                double search_px);

/// Estimator of the level of an area.
enum class LevelEstimate {
  median,  ///< median; not affected by a single bad pixel or a pixel on an edge
  /// Mean for pictures with only a few integer levels, for which a median is too coarse. Pixels are excluded if they
  /// deviate by more than half the contrast and also by more than eight standard deviations of the ring.
  mean,
};

/// One triangle in which a contrast is measured.
struct ReferenceTriangle {
  double value = 0;      ///< contrast of the triangle
  cv::Point2d place_px;  ///< centroid of the triangle in the picture
  double size_px = 0;
  double noise = 0;  ///< standard error of `value` due to the noise of the pixels round it; 0: not known
};

/// Observed contrast in the unit of the picture, signed.
struct EffectiveContrast {
  double value = 0;  ///< mean over the triangles used
  /// Standard error from the scatter over the triangles; for one triangle, from the scatter of its pixels.
  double standard_error = 0;
  int triangles = 0;
  std::vector<ReferenceTriangle> references;  ///< the triangles used
};

/// Distance from the edge of a triangle to the inner area of effective_contrast(), as a share of the radius of the
/// inscribed circle.
inline constexpr double contrast_inner_share = 0.45;
/// Upper limit of the distance of contrast_inner_share: three blur widths of 0.4 px.
inline constexpr double contrast_inner_most_px = 1.25;
/// Width of the ring of effective_contrast().
inline constexpr double contrast_ring_width_px = 3;

/// Measures the contrast of every triangle of at least `min_size_px`. The contrast is the median of the inner area
/// minus the median of a ring round the triangle. The ring is 3 px wide and begins 1.5 px outside the triangle. The
/// distance from the edge of the triangle to the inner area is 0.45 of the radius of the inscribed circle, at most 1.25
/// px. If `level` is LevelEstimate::mean, means are used instead of medians.
///
/// Blur reduces the contrast, mainly because of the corners. For a total blur of 0.40 px (standard deviation, sampling
/// included), the reduction averaged over sampling phases is 0.4 % for triangles of 4 px, 0.04 % for 5 px and less than
/// 0.01 % for 6 px or more. To correct for a known blur, divide the result by that of a simulated picture of
/// contrast 1. Errors: `invalid_input` (no triangle of this size), `calibration` (a triangle is partly outside the
/// picture).
[[nodiscard]] Result<EffectiveContrast> effective_contrast(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                           const Registration& registration, double min_size_px,
                                                           LevelEstimate level = LevelEstimate::median);

/// Returns the mean contrast of the triangles from 2 px up to `below_px`, each weighted by its area. The contrast of a
/// triangle is the sum of (picture minus surround) over the triangle and 2 px round it, divided by the area of the
/// triangle. This contrast does not depend on sampling phases. Blur and neighbours change the result by a factor that
/// does not depend on the contrast, so only relative changes of the result are meaningful. Empty: no triangle of this
/// size has a surround without other triangles in the picture.
[[nodiscard]] std::optional<double> contrast_of_small_triangles(const cv::Mat1d& picture,
                                                                const TargetPlate& mounted_plate,
                                                                const Registration& registration, double below_px);

}  // namespace todbench
