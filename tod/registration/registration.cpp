// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/plate/plate_outlines.h"
#include "tod/registration/plate_attempt.h"

namespace todbench {
namespace {

tl::unexpected<Error> contradiction(const TargetPlate& plate, const std::string& what) {
  return fail(ErrorCode::calibration, "plate \"" + plate.name + "\" " + what);
}

/// Sentence about the triangles that are not entirely inside the picture with the 2 px round them that a surround
/// needs; empty if all are.
std::string outside_picture(const TargetPlate& plate, const cv::Matx33d& mapping, cv::Size picture) {
  constexpr double margin = 2;
  int count = 0;
  std::string first;
  for (const PlateTriangle& t : plate.triangles) {
    const Polygon outline = outline_in_picture(mapping, t, t.apex);
    const bool inside = std::ranges::all_of(outline, [&](const cv::Point2d& p) {
      return p.x >= margin && p.y >= margin && p.x <= picture.width - 1 - margin && p.y <= picture.height - 1 - margin;
    });
    if (inside) continue;
    const cv::Point2d place = to_pixel(mapping, t.position_mm);
    if (count++ == 0) first = t.name + " would be at (" + fixed(place.x, 1) + ", " + fixed(place.y, 1) + ")";
  }
  if (count == 0) return {};
  return "is partly outside the picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
         " pixels: " + std::to_string(count) + " of " + std::to_string(plate.triangles.size()) +
         " triangles are not inside the picture, " + first;
}

Result<void> check_input(const cv::Mat1d& picture, const TargetPlate& plate, const RegistrationOptions& options) {
  const auto wrong = [&](const std::string& what) {
    return fail(ErrorCode::invalid_input, "registering plate \"" + plate.name + "\": " + what);
  };
  if (!(options.expected_scale_px_per_mm > 0) || !std::isfinite(options.expected_scale_px_per_mm)) {
    return wrong("the expected scale must be positive, found " + fixed(options.expected_scale_px_per_mm, 4) + " px/mm");
  }
  if (!(options.pixel_aspect >= 0.4 && options.pixel_aspect <= 2.5))
    return wrong("the aspect of a pixel must be from 0.4 to 2.5, found " + fixed(options.pixel_aspect, 4));
  if (options.min_triangles < 1) return wrong("min_triangles must be at least 1");
  if (picture.empty() || !cv::checkRange(picture))
    return wrong("the picture is empty or contains a value that is not finite");
  const auto large = triangles_from(plate, options.min_triangle_px / options.expected_scale_px_per_mm);
  if (static_cast<int>(large.size()) < options.min_triangles) {
    return wrong("only " + std::to_string(large.size()) + " of its " + std::to_string(plate.triangles.size()) +
                 " triangles are at least " + fixed(options.min_triangle_px, 1) + " px at " +
                 fixed(options.expected_scale_px_per_mm, 4) + " px/mm, and " + std::to_string(options.min_triangles) +
                 " are needed");
  }
  return {};
}

std::string percent(double share) {
  return fixed(100 * share, 1) + " %";
}

/// Pixels per millimetre along x at a place, from the area magnification.
double scale_along_x(const cv::Matx33d& mapping, cv::Point2d plate_mm, double pixel_aspect) {
  return std::sqrt(std::abs(cv::determinant(jacobian(mapping, plate_mm))) * pixel_aspect);
}

/// Pixels per millimetre along the rows and along the columns of the plate.
cv::Point2d axis_scales(const cv::Matx33d& mapping) {
  const cv::Matx22d j = jacobian(mapping, {0, 0});
  return {std::hypot(j(0, 0), j(1, 0)), std::hypot(j(0, 1), j(1, 1))};
}

double stretch_of(const cv::Matx33d& mapping, double pixel_aspect) {
  const cv::Point2d scales = axis_scales(with_square_pixels(mapping, pixel_aspect));
  return scales.x / scales.y - 1;
}

tl::unexpected<Error> stretched(const TargetPlate& plate, const cv::Matx33d& mapping,
                                const RegistrationOptions& options) {
  const cv::Point2d scales = axis_scales(mapping);
  const bool square = options.pixel_aspect == 1;
  return contradiction(
      plate, "is stretched in the picture: " + fixed(scales.x, 4) + " px/mm along x and " + fixed(scales.y, 4) +
                 " px/mm along y differ by " + percent(stretch_of(mapping, options.pixel_aspect)) +
                 (square ? "" : " from those of pixels " + fixed(options.pixel_aspect, 3) + " times as high as wide") +
                 ", at most " + percent(options.max_stretch) + " are allowed: check whether the pixels are " +
                 (square ? "square" : "as the sensor states (pitch_y_um)") + " and the plate faces the camera");
}

/// The mapping by which a picture with unequal scales shows the plate as it is mounted, if it does: of the layouts
/// drawn with several ratios that with the most located triangles, then the smallest residual.
std::optional<cv::Matx33d> stretched_mapping(const PlateSearch& search, const TargetPlate& plate) {
  std::size_t most = 0;
  FittedMapping best;
  for (const double ratio : {1.1, 1 / 1.1, 1.2, 1 / 1.2, 1.3, 1 / 1.3}) {
    const double wide = std::sqrt(ratio);
    TargetPlate drawn = plate;
    for (PlateTriangle& t : drawn.triangles) t.position_mm = {t.position_mm.x * wide, t.position_mm.y / wide};
    const auto found = attempt_mounting(search, drawn, Mounting::identity);
    if (!found || !found->agrees() || static_cast<int>(found->located.size()) < search.options.min_triangles) continue;
    std::vector<cv::Point2d> of_file = places_of(found->located);
    for (cv::Point2d& p : of_file) p = {p.x / wide, p.y * wide};
    const FittedMapping fitted = fit_mapping(of_file, found->pixels, search.options);
    // A layout that fits by chance has scales unlike those with which it was drawn.
    const double stretch = stretch_of(fitted.plate_to_pixel, search.options.pixel_aspect);
    if (std::abs(std::log((1 + stretch) / ratio)) > 0.06) continue;
    if (std::pair(most, -best.residual_px) >= std::pair(found->located.size(), -fitted.residual_px)) continue;
    most = found->located.size();
    best = fitted;
  }
  if (most == 0 || best.residual_px > search.options.max_residual_px) return std::nullopt;
  return best.plate_to_pixel;
}

/// Pixels per millimetre of a picture that shows the plate as it is mounted, but at a scale beyond the range that is
/// searched otherwise.
std::optional<double> scale_of_another_distance(const PlateSearch& search, const TargetPlate& plate) {
  RegistrationOptions options = search.options;
  options.min_triangles = std::min(credible_pairs, options.min_triangles);
  for (const double factor : {1.45, 0.7, 2.0, 0.5, 2.8, 0.35, 4.0, 0.25}) {
    options.expected_scale_px_per_mm = factor * search.options.expected_scale_px_per_mm;
    if (!check_input(search.picture, plate, options)) continue;
    const PlateSearch there = search_for(search.picture, plate, options);
    auto found = attempt_mounting(there, plate, Mounting::identity);
    if (!found || !found->agrees() || static_cast<int>(found->located.size()) < options.min_triangles) continue;
    const FittedMapping fitted = refine_attempt(there, *found);
    const double scale = scale_along_x(fitted.plate_to_pixel, {0, 0}, options.pixel_aspect);
    const bool fits = fitted.residual_px <= options.max_residual_px &&
                      std::abs(stretch_of(fitted.plate_to_pixel, options.pixel_aspect)) <= options.max_stretch;
    if (fits && std::abs(scale / search.options.expected_scale_px_per_mm - 1) > searched_scale_range) return scale;
  }
  return std::nullopt;
}

tl::unexpected<Error> of_unplanned_scale(const TargetPlate& plate, double scale, const RegistrationOptions& options) {
  const double expected = options.expected_scale_px_per_mm;
  return contradiction(plate, "does not have the planned scale: the picture shows " + fixed(scale, 4) +
                                  " px/mm, distance and IFOV give " + fixed(expected, 4) + " px/mm, a deviation of " +
                                  percent(scale / expected - 1) + "; at most " + percent(options.max_scale_deviation) +
                                  " are allowed");
}

/// Why the stated mounting was not found: another mounting, another scale, unequal scales, or too few matches.
tl::unexpected<Error> explain(const PlateSearch& search, const TargetPlate& plate,
                              const std::optional<PlateAttempt>& stated) {
  for (const Mounting relative : all_mountings) {
    if (relative == Mounting::identity) continue;
    const auto other = attempt_mounting(search, plate, relative);
    if (other && other->pairs() >= std::min(credible_pairs, search.options.min_triangles) && other->agrees() &&
        static_cast<int>(other->located.size()) >= std::min(credible_pairs, search.options.min_triangles)) {
      return contradiction(plate, "seems to be mounted " + std::string(to_string(other->mounting)) + ", not " +
                                      std::string(to_string(plate.mounting)) + ": " +
                                      std::to_string(other->located.size()) + " of " + std::to_string(other->judged) +
                                      " large triangles point as in that mounting, " +
                                      std::to_string(stated ? stated->located.size() : 0) + " as in the stated one");
    }
  }
  if (const auto scale = scale_of_another_distance(search, plate))
    return of_unplanned_scale(plate, *scale, search.options);
  if (const auto mapping = stretched_mapping(search, plate);
      mapping && std::abs(stretch_of(*mapping, search.options.pixel_aspect)) > search.options.max_stretch)
    return stretched(plate, *mapping, search.options);
  const std::string spots = std::to_string(search.blobs[0].size()) + " warm and " +
                            std::to_string(search.blobs[1].size()) + " cold spots were found";
  const std::size_t wanted =
      triangles_from(plate, search.options.min_triangle_px / search.options.expected_scale_px_per_mm).size();
  if (!stated || stated->pairs() < credible_pairs) {
    return contradiction(plate, "was not found: " + std::to_string(stated ? stated->pairs() : 0) + " of its " +
                                    std::to_string(wanted) + " large triangles fit one arrangement, " + spots);
  }
  return contradiction(plate, "does not match its file: its large triangles were found, but only " +
                                  std::to_string(stated->located.size()) + " of " + std::to_string(stated->judged) +
                                  " point as stated, and no other mounting fits better: check which plate is inserted");
}

Registration describe(const FittedMapping& fitted, const PlateAttempt& at, const RegistrationOptions& options) {
  Registration r;
  r.pixel_aspect = options.pixel_aspect;
  r.plate_to_pixel = fitted.plate_to_pixel;
  r.mapping = fitted.mapping;
  r.residual_px = fitted.residual_px;
  r.triangles_used = static_cast<int>(at.located.size());
  const cv::Matx22d j = jacobian(with_square_pixels(r.plate_to_pixel, r.pixel_aspect), {0, 0});
  r.scale_px_per_mm = r.scale_at({0, 0});
  // Rotation part of the polar decomposition.
  r.rotation_deg = std::atan2(j(1, 0) - j(0, 1), j(0, 0) + j(1, 1)) * 180 / std::numbers::pi;
  r.scale_deviation = r.scale_px_per_mm / options.expected_scale_px_per_mm - 1;
  r.contrast_sign = at.sign;
  r.blur_px = at.blur_px;
  return r;
}

}  // namespace

std::string_view to_string(PlateMapping mapping) {
  switch (mapping) {
    case PlateMapping::translation:
      return "translation";
    case PlateMapping::similarity:
      return "similarity";
    case PlateMapping::affine:
      return "affine";
    case PlateMapping::homography:
      return "homography";
  }
  return "unknown";
}

cv::Point2d Registration::pixel(cv::Point2d plate_mm) const {
  return to_pixel(plate_to_pixel, plate_mm);
}

double Registration::scale_at(cv::Point2d plate_mm) const {
  return scale_along_x(plate_to_pixel, plate_mm, pixel_aspect);
}

Registration Registration::shifted(cv::Point2d shift_mm) const {
  Registration result = *this;
  result.plate_to_pixel = plate_to_pixel * cv::Matx33d(1, 0, shift_mm.x, 0, 1, shift_mm.y, 0, 0, 1);
  return result;
}

Registration Registration::moved(cv::Point2d shift_px) const {
  Registration result = *this;
  result.plate_to_pixel = cv::Matx33d(1, 0, shift_px.x, 0, 1, shift_px.y, 0, 0, 1) * plate_to_pixel;
  return result;
}

Result<Registration> register_plate(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                    const RegistrationOptions& options) {
  TODBENCH_TRY_VOID(check_input(picture, mounted_plate, options));
  const PlateSearch search = search_for(picture, mounted_plate, options);

  auto found = attempt_mounting(search, mounted_plate, Mounting::identity);
  if (!found || !found->agrees()) return explain(search, mounted_plate, found);
  if (static_cast<int>(found->located.size()) < options.min_triangles) {
    const std::string outside = outside_picture(mounted_plate, found->match.plate_to_pixel, picture.size());
    if (!outside.empty()) return contradiction(mounted_plate, outside);
    return contradiction(mounted_plate,
                         "has too few usable triangles in the picture: " + std::to_string(found->located.size()) +
                             " of " + std::to_string(found->large.size()) + " large ones were located, " +
                             std::to_string(options.min_triangles) + " are needed");
  }
  const FittedMapping fitted = refine_attempt(search, *found);
  const Registration result = describe(fitted, *found, options);
  if (result.residual_px > options.max_residual_px) {
    return contradiction(mounted_plate, "does not fit its file: the located triangles are " +
                                            fixed(result.residual_px, 3) +
                                            " px rms from their places in the file, at most " +
                                            fixed(options.max_residual_px, 3) + " px are allowed");
  }
  if (std::abs(stretch_of(result.plate_to_pixel, options.pixel_aspect)) > options.max_stretch) {
    // With a row of the layout assigned to another one, the similarity leads to wrong scales.
    const cv::Matx33d mapping = stretched_mapping(search, mounted_plate).value_or(result.plate_to_pixel);
    return stretched(mounted_plate, mapping, options);
  }
  if (std::abs(result.scale_deviation) > options.max_scale_deviation)
    return of_unplanned_scale(mounted_plate, result.scale_px_per_mm, options);
  if (std::abs(result.rotation_deg) > options.max_rotation_deg) {
    return contradiction(mounted_plate, "is rotated by " + fixed(result.rotation_deg, 1) + " degrees; at most " +
                                            fixed(options.max_rotation_deg, 1) + " degrees are allowed");
  }
  const std::string outside = outside_picture(mounted_plate, result.plate_to_pixel, picture.size());
  if (!outside.empty()) return contradiction(mounted_plate, outside);
  return result;
}

}  // namespace todbench
