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
  double max_scale_deviation = 0.02;    ///< relative; a larger deviation means that plan and picture contradict each
                                        ///< other
  double max_rotation_deg = 10;
  /// Largest relative difference of the ratio of the scales along x and y from `pixel_aspect`. The triangles of the
  /// observer have the shape for pixels of this aspect. Within this limit the acuity at the mean scale changes by less
  /// than 0.5 % (docs/validation/measurement.md).
  double max_stretch = 0.04;
  double max_residual_px = 0.25;  ///< rms over the triangles used
  double min_triangle_px = 2.5;   ///< smallest size (square root of area) of a triangle that is located separately
  int min_triangles = 6;          ///< 1 is allowed for a plate of one triangle: only its position is then measured
};

/// Mapping of the plate to the picture, from simple to general. A more general mapping is used only if the located
/// centroids require it (F test at 1 %). Four parameters are sufficient for a camera that looks perpendicularly at a
/// plate, and each additional parameter increases the error of prediction.
enum class PlateMapping { translation, similarity, affine, homography };
[[nodiscard]] std::string_view to_string(PlateMapping mapping);

/// Mapping from plate to pixels with its quality. Pixel (column, row) has its centre at the integer position.
struct Registration {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();  ///< mm on the mounted plate -> pixels
  double residual_px = 0;                           ///< rms distance between located and mapped centroids
  int triangles_used = 0;
  double scale_px_per_mm = 0;  ///< along x: scale_at() in the middle of the plate
  double pixel_aspect = 1;     ///< aspect stated in the options
  double rotation_deg = 0;     ///< clockwise in the picture
  double scale_deviation = 0;  ///< relative to the expected scale
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

/// Locates a mounted plate in an averaged high-contrast picture (kelvin or counts, either sign). Small triangles are
/// never located separately. The search covers scales within 30 % of the expected scale and 10 degrees of rotation
/// beyond the limit, so that a wrong scale or rotation can be reported. Errors: `calibration` with a reason (plate not
/// found or partly outside the picture, unexpected scale or rotation, unequal scales, residual too large, or large
/// triangles that do not point as stated, because the plate has another mounting), `invalid_input` (options or plate
/// that make registration impossible, or a picture that is not finite).
[[nodiscard]] Result<Registration> register_plate(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const RegistrationOptions& options);

/// Returns the outlines, in pixels of the picture, of the triangles of at least `smallest_px`.
[[nodiscard]] std::vector<Polygon> large_outlines(const TargetPlate& mounted_plate, const Registration& registration,
                                                  double smallest_px);

/// Measures the motion of the picture, in pixels, since `registration`. It is used for benches on which a person or an
/// unknown drift moves the plate. Uses the large triangles of an averaged picture, at any contrast of either sign at
/// which they are visible. Error: `calibration` if they cannot be found within `search_px` in x and y.
[[nodiscard]] Result<cv::Point2d> measure_shift(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                const Registration& registration, const RegistrationOptions& options,
                                                double search_px);

/// Estimator of the level of an area.
enum class LevelEstimate {
  median,  ///< not affected by a single bad pixel or a pixel on an edge
  /// For pictures with only a few integer levels, which a median cannot resolve. Pixels are excluded if they deviate by
  /// more than half the contrast and eight standard deviations of the ring.
  mean,
};

/// One triangle in which a contrast is measured.
struct ReferenceTriangle {
  double value = 0;      ///< its contrast
  cv::Point2d place_px;  ///< its centroid
  double size_px = 0;
  double noise = 0;  ///< standard error of `value` due to the noise of the pixels round it; 0: not known
};

/// Observed contrast in the unit of the picture, signed.
struct EffectiveContrast {
  double value = 0;           ///< mean over the triangles used
  double standard_error = 0;  ///< from the scatter over triangles; for one triangle from the scatter of its pixels
  int triangles = 0;
  std::vector<ReferenceTriangle> references;  ///< the triangles used
};

/// Dimensions of the areas of effective_contrast().
inline constexpr double contrast_inner_share = 0.45;    ///< distance from the edge to the inner area, as a share of the
                                                        ///< inscribed radius
inline constexpr double contrast_inner_most_px = 1.25;  ///< upper limit of this distance: three blur widths of 0.4 px
inline constexpr double contrast_ring_width_px = 3;

/// Measures the contrast of every triangle of at least `min_size_px`. It is the median of the inside minus the median
/// of a ring that is 3 px wide and begins 1.5 px outside. The inside begins at 0.45 of the inscribed radius from the
/// edge, at most 1.25 px. Means are used if `level` states so.
///
/// Blur reduces the result, mostly in the corners. For a total blur of 0.40 px (standard deviation, box included) the
/// reduction is 0.4 % at 4 px, 0.04 % at 5 px and less than 0.01 % from 6 px, each averaged over sampling phases. If
/// the blur is known, divide by the result for a simulated picture. Errors: `invalid_input` (no triangle is that
/// large), `calibration` (a triangle leaves the picture).
[[nodiscard]] Result<EffectiveContrast> effective_contrast(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                           const Registration& registration, double min_size_px,
                                                           LevelEstimate level = LevelEstimate::median);

/// Returns the mean contrast of the triangles from 2 px up to `below_px`, each weighted by its area. The contrast is
/// the sum of the picture minus its surround, over a triangle and 2 px round it, divided by the area. It does not
/// depend on sampling phases. Blur and neighbours change it by a factor that does not depend on the contrast, so only
/// its changes are meaningful. Empty: no such triangle has a free surround in the picture.
[[nodiscard]] std::optional<double> contrast_of_small_triangles(const cv::Mat1d& picture,
                                                                const TargetPlate& mounted_plate,
                                                                const Registration& registration, double below_px);

}  // namespace todbench
