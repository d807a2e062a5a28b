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
  double max_scale_deviation = 0.02;    ///< relative; a larger one means that plan and picture contradict each other
  double max_rotation_deg = 10;
  /// Relative difference of the scales along x and y from `pixel_aspect`. The triangles of the observer are made for
  /// pixels of this shape: within this limit the acuity of the mean scale changes by less than 0.5 %
  /// (docs/validation/measurement.md).
  double max_stretch = 0.04;
  double max_residual_px = 0.25;  ///< rms over the triangles used
  double min_triangle_px = 2.5;   ///< smallest size (square root of area) of a triangle that is located separately
  int min_triangles = 6;          ///< 1 is allowed for a plate of one triangle: only its place is then measured
};

/// Mapping of the plate to the picture, from simple to general. A more general one is used only if the located
/// centroids require it (F test at 1 %): a camera that looks straight at a plate needs four parameters, and each
/// further one enlarges the error of prediction.
enum class PlateMapping { translation, similarity, affine, homography };
[[nodiscard]] std::string_view to_string(PlateMapping mapping);

/// Mapping from plate to pixels with its quality. Pixel (column, row) has its centre at the integer position.
struct Registration {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();  ///< mm on the mounted plate -> pixels
  double residual_px = 0;                           ///< rms distance between located and mapped centroids
  int triangles_used = 0;
  double scale_px_per_mm = 0;  ///< along x: scale_at() the middle of the plate
  double pixel_aspect = 1;     ///< that of the options
  double rotation_deg = 0;     ///< clockwise in the picture
  double scale_deviation = 0;  ///< relative to the expected scale
  double contrast_sign = 1;    ///< +1: triangles warmer than their surround
  double blur_px = 0.45;       ///< standard deviation of the Gaussian that fits the edges of the triangles best
  PlateMapping mapping = PlateMapping::similarity;

  /// Pixel position of a place on the mounted plate.
  [[nodiscard]] cv::Point2d pixel(cv::Point2d plate_mm) const;
  /// Pixels per millimetre along x at a place: sqrt(m a), m the area magnification and a the aspect of a pixel.
  [[nodiscard]] double scale_at(cv::Point2d plate_mm) const;
  /// The same registration for a plate moved by `shift_mm` in its own plane.
  [[nodiscard]] Registration shifted(cv::Point2d shift_mm) const;
  /// The same registration moved by `shift_px` in the picture.
  [[nodiscard]] Registration moved(cv::Point2d shift_px) const;
};

/// Locates a mounted plate in an averaged high-contrast picture (kelvin or counts, either sign). Small triangles are
/// never located separately. The search covers scales within 30 % of the expected one and 10 degrees of rotation beyond
/// the limit, so that a wrong scale or rotation can be reported. Errors: `calibration` with a reason (plate not found
/// or partly outside the picture, unexpected scale or rotation, unequal scales, residual too large, or large triangles
/// that do not point as the mounted plate states, so that the mounting is another one), `invalid_input` (options or
/// plate that make registration impossible, or a picture that is not finite).
[[nodiscard]] Result<Registration> register_plate(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const RegistrationOptions& options);

/// Outlines in the picture, in pixels, of the triangles of at least `smallest_px`.
[[nodiscard]] std::vector<Polygon> large_outlines(const TargetPlate& mounted_plate, const Registration& registration,
                                                  double smallest_px);

/// Movement of the picture, in pixels, since `registration`: for benches on which a hand or an unknown drift moves the
/// plate. Uses the large triangles of an averaged picture at any contrast of either sign that shows them. Errors:
/// `calibration` if they cannot be found within `search_px` in x and y.
[[nodiscard]] Result<cv::Point2d> measure_shift(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                const Registration& registration, const RegistrationOptions& options,
                                                double search_px);

/// Estimator of the level of an area.
enum class LevelEstimate {
  median,  ///< not affected by a bad pixel or one on an edge
  /// For pictures of a few whole levels, which a median cannot resolve. Pixels that are off by half the contrast and
  /// eight standard deviations of the ring are left out.
  mean,
};

/// One triangle by which a contrast is measured.
struct ReferenceTriangle {
  double value = 0;      ///< its contrast
  cv::Point2d place_px;  ///< its centroid
  double size_px = 0;
  double noise = 0;  ///< standard error of `value` from the noise of the pixels round it; 0: not known
};

/// Observed contrast in the unit of the picture, signed.
struct EffectiveContrast {
  double value = 0;           ///< mean over the triangles used
  double standard_error = 0;  ///< from the scatter over triangles; with one triangle from the scatter of its pixels
  int triangles = 0;
  std::vector<ReferenceTriangle> references;  ///< those used
};

/// Areas of effective_contrast().
inline constexpr double contrast_inner_share = 0.45;    ///< of the inscribed radius, from the edge to the inside
inline constexpr double contrast_inner_most_px = 1.25;  ///< the same at most: three blur widths of 0.4 px
inline constexpr double contrast_ring_width_px = 3;

/// Measures the contrast of every triangle of at least `min_size_px`: median of the inside (0.45 of the inscribed
/// radius, at most 1.25 px, away from the edge) minus median of a ring 3 px wide that begins 1.5 px outside; means if
/// `level` states so.
///
/// Blur reduces the result, mostly in the corners: for a total blur of 0.40 px (standard deviation, box included) by
/// 0.4 % at 4 px, 0.04 % at 5 px and less than 0.01 % from 6 px, each the mean over sampling phases. If the blur is
/// known, divide by the result for a simulated picture. Errors: `invalid_input` (no triangle is that large),
/// `calibration` (a triangle leaves the picture).
[[nodiscard]] Result<EffectiveContrast> effective_contrast(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                           const Registration& registration, double min_size_px,
                                                           LevelEstimate level = LevelEstimate::median);

/// Mean contrast of the triangles from 2 px up to `below_px`, each with the weight of its area: the sum of the picture
/// minus its surround over a triangle and 2 px round it, divided by the area. Sampling phases do not change it; blur
/// and neighbours give it a factor that does not depend on the contrast. Only its changes are of use. Empty: no such
/// triangle has a free surround in the picture.
[[nodiscard]] std::optional<double> contrast_of_small_triangles(const cv::Mat1d& picture,
                                                                const TargetPlate& mounted_plate,
                                                                const Registration& registration, double below_px);

}  // namespace todbench
