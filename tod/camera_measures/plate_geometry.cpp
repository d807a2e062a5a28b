// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/plate_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/median.h"
#include "acquisition/base/try.h"
#include "tod/plate/plate_outlines.h"
#include "tod/registration/shift_fit.h"

namespace todbench {
namespace {

constexpr int lens_parameters = 9;  // eight of the homography, one of the distortion
constexpr std::size_t least_triangles = 10;
constexpr double least_triangle_px = 1.5;
constexpr double triangle_reach_px = 1.5;
constexpr double outline_px = 0.004;     // shift of a triangle's place by blur and sampling
constexpr double least_signal = 10;      // contrast of a triangle over its standard error
constexpr double widest_place_px = 0.1;  // standard error
using LensParameters = cv::Matx<double, lens_parameters, 1>;

/// Step of the derivatives: parameters are of the size of pixels, or of 1.
double step_of(int parameter) {
  return parameter < 6 ? 1e-3 : 1e-6;
}

/// Units of the fit: the plate in units of its half-height, so that all parameters are of one size. Lengths in the
/// picture of the lens are in pixels along x.
struct Lens {
  double unit_mm = 1;
  cv::Point2d centre;       ///< of the picture
  double corner_px = 1;     ///< from the centre
  double pixel_aspect = 1;  ///< height of a pixel over its width

  [[nodiscard]] cv::Point2d undistorted(const LensParameters& p, cv::Point2d mm) const {
    const double x = mm.x / unit_mm, y = mm.y / unit_mm, w = p(6) * x + p(7) * y + 1;
    return {(p(0) * x + p(1) * y + p(2)) / w, (p(3) * x + p(4) * y + p(5)) / w};
  }
  /// A place on the plate in the picture.
  [[nodiscard]] cv::Point2d pixel(const LensParameters& p, cv::Point2d mm) const {
    const cv::Point2d q = undistorted(p, mm);
    const cv::Point2d shown = q * (1 + p(8) * q.dot(q) / (corner_px * corner_px));
    return centre + cv::Point2d(shown.x, shown.y / pixel_aspect);
  }
};

struct LocatedTriangle {
  const PlateTriangle* triangle;
  cv::Point2d pixel;
  cv::Point2d u_px;
};

/// The outline through the lens: distortion bends the sides.
Polygon outline_behind(const Lens& lens, const LensParameters& p, const PlateTriangle& t) {
  const Polygon corners = triangle(t.size_mm, t.apex, t.position_mm);
  constexpr int pieces = 4;
  Polygon outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2d side = corners[(i + 1) % corners.size()] - corners[i];
    for (int k = 0; k < pieces; ++k) outline.push_back(lens.pixel(p, corners[i] + side * (1.0 * k / pieces)));
  }
  return outline;
}

/// Triangles that stand out of the noise near their expected places.
std::vector<LocatedTriangle> locate_triangles(const cv::Mat1d& picture, const TargetPlate& plate,
                                              const Registration& where, const Lens& lens, const LensParameters& p) {
  std::vector<LocatedTriangle> located;
  for (const PlateTriangle& t : plate.triangles) {
    if (t.size_mm * where.scale_px_per_mm < least_triangle_px) continue;
    const Polygon outline = outline_behind(lens, p, t);
    const auto fit = fit_shift(picture, std::span(&outline, 1), where.blur_px, {0, 0}, triangle_reach_px);
    if (!fit || fit->amplitudes[0] * where.contrast_sign < least_signal * fit->amplitude_errors[0]) continue;
    if (!(fit->standard_error.x < widest_place_px) || !(fit->standard_error.y < widest_place_px)) continue;
    located.push_back({&t,
                       lens.pixel(p, t.position_mm) + fit->shift,
                       {std::hypot(fit->standard_error.x, outline_px), std::hypot(fit->standard_error.y, outline_px)}});
  }
  return located;
}

LensParameters start_of(const Registration& where, const Lens& lens) {
  // The homography in the units of the fit, with its last element 1.
  const cv::Matx33d to_unit(lens.unit_mm, 0, 0, 0, lens.unit_mm, 0, 0, 0, 1);
  const double a = lens.pixel_aspect;
  const cv::Matx33d to_middle(1, 0, -lens.centre.x, 0, a, -a * lens.centre.y, 0, 0, 1);
  const cv::Matx33d h = to_middle * where.plate_to_pixel * to_unit;
  LensParameters p;
  for (int i = 0; i < 8; ++i) p(i) = h(i / 3, i % 3) / h(2, 2);
  p(8) = 0;
  return p;
}

/// Derivatives of the places in units of their uncertainties, by central differences.
cv::Mat1d weighted_slopes(const std::vector<LocatedTriangle>& located, const Lens& lens, const LensParameters& p) {
  cv::Mat1d slopes(static_cast<int>(2 * located.size()), lens_parameters);
  for (int k = 0; k < lens_parameters; ++k) {
    LensParameters up = p, down = p;
    up(k) += step_of(k), down(k) -= step_of(k);
    for (std::size_t i = 0; i < located.size(); ++i) {
      const cv::Point2d mm = located[i].triangle->position_mm;
      const cv::Point2d d = (lens.pixel(up, mm) - lens.pixel(down, mm)) * (0.5 / step_of(k));
      const int row = static_cast<int>(2 * i);
      slopes(row, k) = d.x / located[i].u_px.x, slopes(row + 1, k) = d.y / located[i].u_px.y;
    }
  }
  return slopes;
}

std::vector<cv::Point2d> residuals(const std::vector<LocatedTriangle>& located, const Lens& lens,
                                   const LensParameters& p) {
  std::vector<cv::Point2d> left;
  for (const LocatedTriangle& t : located) left.push_back(t.pixel - lens.pixel(p, t.triangle->position_mm));
  return left;
}

cv::Mat1d weighted(const std::vector<LocatedTriangle>& located, const std::vector<cv::Point2d>& left) {
  cv::Mat1d out(static_cast<int>(2 * located.size()), 1);
  for (std::size_t i = 0; i < located.size(); ++i) {
    const int row = static_cast<int>(2 * i);
    out(row, 0) = left[i].x / located[i].u_px.x, out(row + 1, 0) = left[i].y / located[i].u_px.y;
  }
  return out;
}

struct LensFit {
  LensParameters parameters;
  std::vector<cv::Point2d> left_px;
  double chi2 = 0;       ///< of the places in units of their uncertainties
  cv::Mat1d covariance;  ///< for a chi2 equal to its number of degrees of freedom
};

std::optional<LensFit> fit_lens(const std::vector<LocatedTriangle>& located, const Lens& lens, LensParameters p) {
  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    cv::Mat1d step;
    const cv::Mat1d left = weighted(located, residuals(located, lens, p));
    if (!cv::solve(weighted_slopes(located, lens, p), left, step, cv::DECOMP_QR)) return std::nullopt;
    for (int k = 0; k < lens_parameters; ++k) p(k) += step(k, 0);
  }
  const cv::Mat1d slopes = weighted_slopes(located, lens, p);
  LensFit fit{p, residuals(located, lens, p), 0, {}};
  fit.chi2 = cv::norm(weighted(located, fit.left_px), cv::NORM_L2SQR);
  const cv::Mat1d normal = slopes.t() * slopes;
  if (!cv::checkRange(normal) || cv::invert(normal, fit.covariance, cv::DECOMP_CHOLESKY) == 0 ||
      !cv::checkRange(fit.covariance))
    return std::nullopt;
  return fit;
}

/// The triangle with the largest residual, if that is significant.
std::optional<std::size_t> outlier(const std::vector<LocatedTriangle>& located, const LensFit& fit) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < located.size(); ++i)
    lengths.push_back(std::hypot(fit.left_px[i].x / located[i].u_px.x, fit.left_px[i].y / located[i].u_px.y));
  const auto worst = static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
  constexpr double far = 6, harmless_px = 0.02;  // in medians of a residual's length, which is 1.18 of its scatter
  if (cv::norm(fit.left_px[worst]) <= harmless_px || lengths[worst] <= far * median(lengths)) return std::nullopt;
  return worst;
}

/// A quantity derived from the parameters, with its interval.
class DerivedQuantity {
 public:
  DerivedQuantity(const LensFit& fit, double factor) : fit_(fit), factor_(factor) {}
  Estimate operator()(const std::function<double(const LensParameters&)>& of) const {
    cv::Mat1d gradient(1, lens_parameters);
    for (int k = 0; k < lens_parameters; ++k) {
      LensParameters up = fit_.parameters, down = fit_.parameters;
      up(k) += step_of(k), down(k) -= step_of(k);
      gradient(0, k) = (of(up) - of(down)) / (2 * step_of(k));
    }
    const cv::Mat1d variance = gradient * fit_.covariance * gradient.t();
    const double value = of(fit_.parameters), half = factor_ * std::sqrt(std::max(0.0, variance(0, 0)));
    return {value, value - half, value + half};
  }

 private:
  const LensFit& fit_;
  double factor_;  ///< half-width of the interval over the standard deviation
};

/// Pixels per millimetre at a place of the plate, without distortion.
cv::Matx22d undistorted_scale(const Lens& lens, const LensParameters& p, cv::Point2d mm) {
  const cv::Matx33d h(p(0), p(1), p(2), p(3), p(4), p(5), p(6), p(7), 1);
  return jacobian(h, mm / lens.unit_mm) * (1 / lens.unit_mm);
}

/// Place of the plate in the middle of the picture, which distortion does not move.
cv::Point2d centre_mm(const Lens& lens, const LensParameters& p) {
  const cv::Matx33d h(p(0), p(1), p(2), p(3), p(4), p(5), p(6), p(7), 1);
  const cv::Vec3d at = h.inv() * cv::Vec3d(0, 0, 1);
  return cv::Point2d(at(0), at(1)) * (lens.unit_mm / at(2));
}

double area_scale(const Lens& lens, const LensParameters& p, cv::Point2d mm) {
  return std::sqrt(std::abs(cv::determinant(undistorted_scale(lens, p, mm))));
}

PlateGeometry described(const std::vector<LocatedTriangle>& located, const Lens& lens, const LensFit& fit,
                        const TargetPlate& plate) {
  const double freedom = static_cast<double>(2 * located.size()) - lens_parameters;
  const double t = quantile(distribution::StudentsT(freedom), 0.975);
  // A few residuals that are small by chance do not make a place more certain than its noise.
  const DerivedQuantity derived(fit, t * std::max(1.0, std::sqrt(fit.chi2 / freedom)));
  const double w = plate.width_mm / 2, h = plate.height_mm / 2;
  const auto mm_per_px = [&](const cv::Vec2d& pixel) {
    return derived([&, pixel](const LensParameters& p) {
      return cv::norm(undistorted_scale(lens, p, {0, 0}).inv() * pixel);
    });
  };
  const auto keystone = [&](cv::Point2d side) {
    return derived([&, side](const LensParameters& p) {
      return 100 * (area_scale(lens, p, side) / area_scale(lens, p, -side) - 1);
    });
  };
  PlateGeometry out;
  out.mm_per_px_x = mm_per_px({1, 0}), out.mm_per_px_y = mm_per_px({0, lens.pixel_aspect});
  out.centre_x_mm = derived([&](const LensParameters& p) { return centre_mm(lens, p).x; });
  out.centre_y_mm = derived([&](const LensParameters& p) { return centre_mm(lens, p).y; });
  out.rotation_deg = derived([&](const LensParameters& p) {
    const cv::Matx22d j = undistorted_scale(lens, p, {0, 0});
    return std::atan2(j(1, 0) - j(0, 1), j(0, 0) + j(1, 1)) * 180 / std::numbers::pi;
  });
  out.keystone_x_percent = keystone({w, 0}), out.keystone_y_percent = keystone({0, h});
  out.distortion_percent = derived([](const LensParameters& p) { return 100 * p(8); });
  out.corner_px = lens.corner_px;
  double squares = 0;
  for (std::size_t i = 0; i < located.size(); ++i) {
    out.places.push_back({located[i].triangle->name, located[i].pixel, fit.left_px[i]});
    const cv::Point2d off = located[i].pixel - lens.centre;
    out.farthest_px = std::max(out.farthest_px, cv::norm(cv::Point2d(off.x, off.y * lens.pixel_aspect)));
    squares += fit.left_px[i].dot(fit.left_px[i]);
  }
  out.residual_px = std::sqrt(squares / freedom);
  return out;
}

/// The fit without outlying triangles, which are removed from `located`.
Result<LensFit> fitted_lens(std::vector<LocatedTriangle>& located, const Lens& lens, const LensParameters& start,
                            const TargetPlate& plate) {
  for (;;) {
    if (located.size() < least_triangles) {
      return fail(ErrorCode::calibration,
                  fmt::format("the geometry of plate '{1}' needs at least {2} located triangles, found {0}",
                              located.size(), plate.name, least_triangles));
    }
    auto fit = fit_lens(located, lens, start);
    if (!fit) return fail(ErrorCode::calibration, "the located triangles do not separate distortion from perspective");
    const auto off = outlier(located, *fit);
    if (!off) return *std::move(fit);
    located.erase(located.begin() + static_cast<std::ptrdiff_t>(*off));
  }
}

}  // namespace

Result<PlateGeometry> plate_geometry(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                     const Registration& where) {
  Lens lens;
  lens.unit_mm = 0.5 * std::max(mounted_plate.width_mm, mounted_plate.height_mm);
  lens.centre = {(picture.cols - 1) / 2.0, (picture.rows - 1) / 2.0};
  lens.pixel_aspect = where.pixel_aspect;
  lens.corner_px = 0.5 * std::hypot(picture.cols, picture.rows * lens.pixel_aspect);
  LensParameters p = start_of(where, lens);
  // The second time with outlines bent by the lens.
  for (int round = 0;; ++round) {
    std::vector<LocatedTriangle> located = locate_triangles(picture, mounted_plate, where, lens, p);
    TODBENCH_TRY(const auto fit, fitted_lens(located, lens, p, mounted_plate));
    if (round == 1) return described(located, lens, fit, mounted_plate);
    p = fit.parameters;
  }
}

}  // namespace todbench
