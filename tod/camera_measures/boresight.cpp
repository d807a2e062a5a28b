// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/boresight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "acquisition/base/normal.h"

namespace todbench {
namespace {

constexpr double same_distance = 1e-3;   // relative
constexpr double ifov_tolerance = 0.01;  // of the ratio of stated IFOV, beside the intervals
constexpr double radians = std::numbers::pi / 180;

double half_of(const Estimate& found) {
  return 0.5 * (found.high - found.low);
}

Estimate around(double value, double half) {
  return {value, value - half, value + half};
}

double mean_ifov(const GeometryMeasure& of) {
  return 0.5 * (of.ifov_mrad(EdgeAxis::x).value + of.ifov_mrad(EdgeAxis::y).value);
}

double relative_half(const GeometryMeasure& of) {
  const PlateGeometry& g = of.geometry;
  return std::max(half_of(g.mm_per_px_x) / g.mm_per_px_x.value, half_of(g.mm_per_px_y) / g.mm_per_px_y.value);
}

/// Whether located triangles lie on all four sides of the middle of the picture.
bool is_surrounded(const GeometryMeasure& of) {
  const cv::Point2d middle((of.picture.width - 1) / 2.0, (of.picture.height - 1) / 2.0);
  bool left = false, right = false, above = false, below = false;
  for (const GeometryPlace& place : of.geometry.places) {
    left = left || place.found_px.x < middle.x, right = right || place.found_px.x > middle.x;
    above = above || place.found_px.y < middle.y, below = below || place.found_px.y > middle.y;
  }
  return left && right && above && below;
}

std::string refusal(const GeometryMeasure& a, const GeometryMeasure& b) {
  if (a.plate != b.plate) return fmt::format("the plates differ: '{}' and '{}'", a.plate, b.plate);
  if (a.picture != b.picture)
    return fmt::format("the pictures differ: {} x {} and {} x {} pixels", a.picture.width, a.picture.height,
                       b.picture.width, b.picture.height);
  for (const GeometryMeasure* of : {&a, &b}) {
    const PlateGeometry& g = of->geometry;
    if (!(g.mm_per_px_x.value > 0) || !(g.mm_per_px_y.value > 0) || !(of->distance_m > 0) ||
        !(of->stated_ifov_mrad > 0) || (half_of(g.centre_x_mm) == 0 && half_of(g.centre_y_mm) == 0))
      return "a session has no line of sight: measure its geometry again with this version";
  }
  if (std::abs(b.distance_m / a.distance_m - 1) > same_distance)
    return fmt::format("the distances differ: {:g} m and {:g} m", a.distance_m, b.distance_m);
  const double measured = mean_ifov(b) / mean_ifov(a), stated = b.stated_ifov_mrad / a.stated_ifov_mrad;
  if (std::abs(std::log(measured / stated)) > ifov_tolerance + std::hypot(relative_half(a), relative_half(b))) {
    return fmt::format(
        "the ratio of the IFOV is {:.4g} by the plate and {:.4g} as stated: a distance, an IFOV or the plate is not as "
        "stated",
        measured, stated);
  }
  if (!is_surrounded(a) || !is_surrounded(b)) return "the located triangles do not surround the middle of the picture";
  return {};
}

}  // namespace

Result<Boresight> boresight(const GeometryMeasure& first, const GeometryMeasure& second) {
  if (const std::string reason = refusal(first, second); !reason.empty())
    return fail(ErrorCode::invalid_input, "no boresight: " + reason);
  const PlateGeometry &a = first.geometry, &b = second.geometry;
  const double x_mm = b.centre_x_mm.value - a.centre_x_mm.value, y_mm = b.centre_y_mm.value - a.centre_y_mm.value;
  const double half_x_mm = std::hypot(half_of(a.centre_x_mm), half_of(b.centre_x_mm));
  const double half_y_mm = std::hypot(half_of(a.centre_y_mm), half_of(b.centre_y_mm));
  // From the axes of the plate to those of the first picture.
  const double c = std::cos(a.rotation_deg.value * radians), s = std::sin(a.rotation_deg.value * radians);
  const double right_mm = c * x_mm - s * y_mm, down_mm = s * x_mm + c * y_mm;
  const double roll_half_mm = half_of(a.rotation_deg) * radians;  // turns the shift
  const double half_right = std::hypot(c * half_x_mm, s * half_y_mm, roll_half_mm * down_mm);
  const double half_down = std::hypot(s * half_x_mm, c * half_y_mm, roll_half_mm * right_mm);
  const double distance_u =
      normal_z95 * std::max(first.distance_relative_u.value_or(0), second.distance_relative_u.value_or(0));
  const auto mrad = [&](double mm, double half) {
    return around(mm / first.distance_m, std::hypot(half, distance_u * mm) / first.distance_m);
  };
  const auto pixels = [](double mm, double half, const Estimate& scale) {
    return around(mm / scale.value, std::hypot(half, mm * half_of(scale) / scale.value) / scale.value);
  };
  Boresight out;
  out.shift_x_mrad = mrad(right_mm, half_right), out.shift_y_mrad = mrad(down_mm, half_down);
  out.shift_x_px = pixels(right_mm, half_right, a.mm_per_px_x);
  out.shift_y_px = pixels(down_mm, half_down, a.mm_per_px_y);
  // The plate turns in the picture against the camera.
  out.roll_mrad = around(1000 * radians * (a.rotation_deg.value - b.rotation_deg.value),
                         1000 * radians * std::hypot(half_of(a.rotation_deg), half_of(b.rotation_deg)));
  out.distance_m = first.distance_m;
  out.ifov_ratio = mean_ifov(second) / mean_ifov(first);
  out.sideways_mrad_per_mm = 1 / first.distance_m;
  return out;
}

}  // namespace todbench
