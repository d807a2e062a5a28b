// SPDX-License-Identifier: GPL-3.0-or-later
// measure_shift: movement of a known plate in the picture.
#include <algorithm>
#include <cmath>

#include "acquisition/base/median.h"
#include "tod/plate/plate_outlines.h"
#include "tod/registration/registration.h"
#include "tod/registration/shift_fit.h"

namespace todbench {
namespace {

/// Below this the joint contrast could be the best of all searched offsets in pure noise: with 500 offsets the largest
/// |t| is about 3.5.
constexpr double significance_needed = 6;
constexpr double share_of_common_contrast_needed = 0.75;

/// Share of the triangles whose contrast is the common one within half of it and four standard errors: a hot pipe that
/// happens to correlate with one triangle is not the plate.
double agreement(const ShiftFit& fit) {
  const double common = median(fit.amplitudes);
  int agreeing = 0;
  for (std::size_t k = 0; k < fit.amplitudes.size(); ++k) {
    const double allowed = std::abs(common) / 2 + 4 * fit.amplitude_errors[k];
    if (std::abs(fit.amplitudes[k] - common) <= allowed && fit.amplitudes[k] * common > 0) ++agreeing;
  }
  return agreeing / static_cast<double>(fit.amplitudes.size());
}

}  // namespace

std::vector<Polygon> large_outlines(const TargetPlate& mounted_plate, const Registration& registration,
                                    double smallest_px) {
  std::vector<Polygon> outlines;
  for (const PlateTriangle& t : mounted_plate.triangles) {
    if (t.size_mm * registration.scale_at(t.position_mm) < smallest_px) continue;
    outlines.push_back(outline_in_picture(registration.plate_to_pixel, t, t.apex));
  }
  return outlines;
}

Result<cv::Point2d> measure_shift(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                  const Registration& registration, const RegistrationOptions& options,
                                  double search_px) {
  const std::string doing = "measuring the shift of plate \"" + mounted_plate.name + "\": ";
  if (picture.empty() || !cv::checkRange(picture)) {
    return fail(ErrorCode::invalid_input, doing + "the picture is empty or contains a value that is not finite");
  }
  const auto outlines = large_outlines(mounted_plate, registration, options.min_triangle_px);
  if (outlines.empty()) {
    return fail(ErrorCode::invalid_input,
                doing + "no triangle is at least " + fixed(options.min_triangle_px, 1) + " px");
  }
  const int reach = std::max(1, static_cast<int>(std::ceil(search_px)));
  const auto coarse = coarse_offset(picture, outlines, registration.blur_px, reach);
  if (!coarse) return fail(ErrorCode::calibration, doing + "its large triangles are at the edge of the picture");
  // The answer is at most 0.71 px from the nearest whole pixel; 1.5 px leave room for noise.
  const auto fit = fit_shift(picture, outlines, registration.blur_px, cv::Point2d(*coarse), 1.5);
  if (!fit || std::abs(fit->joint_significance) < significance_needed ||
      agreement(*fit) < share_of_common_contrast_needed) {
    return fail(ErrorCode::calibration, doing + "its " + std::to_string(outlines.size()) +
                                            " large triangles were not found within " + fixed(search_px, 1) +
                                            " px of their earlier places" +
                                            (fit ? " (contrast over its error " + fixed(fit->joint_significance, 1) +
                                                       ", " + fixed(100 * agreement(*fit), 0) + " % of them agree)"
                                                 : std::string()));
  }
  if (std::max(std::abs(fit->shift.x), std::abs(fit->shift.y)) > search_px) {
    return fail(ErrorCode::calibration, doing + "it has moved by (" + fixed(fit->shift.x, 2) + ", " +
                                            fixed(fit->shift.y, 2) + ") px or more, the search covered " +
                                            fixed(search_px, 1) + " px");
  }
  return fit->shift;
}

}  // namespace todbench
