// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/image_chain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/far_field.h"
#include "sim_devices/sensor/transfer_functions.h"

namespace todbench {
namespace {

/// Pitches round a window within which shapes are computed exactly.
constexpr double near_field = 32;

/// Largest distance of a vertex from the origin.
double reach(const Polygon& shape) {
  double largest = 0;
  for (const auto& v : shape) largest = std::max(largest, std::hypot(v.x, v.y));
  return largest;
}

/// The inverse of on_detectors().
Polygon in_space(Polygon shape, double aspect) {
  for (auto& corner : shape) corner.y *= aspect;
  return shape;
}

}  // namespace

Polygon on_detectors(Polygon shape_pitch, const SensorSpec& spec) {
  return in_space(std::move(shape_pitch), 1 / spec.pitch_aspect());
}

ImageChain::ImageChain(SensorSpec spec, SensorPlan plan, Accuracy accuracy, SceneMotion motion)
    : spec_(std::move(spec)),
      plan_(std::move(plan)),
      accuracy_(accuracy),
      motion_(motion),
      spread_(spread_of(scope())),
      readout_slope_(readout_slope_of(scope())),
      band_per_pitch_(highest_frequency(spec_, plan_, accuracy_)) {
  CV_Assert(std::abs(readout_slope_.y) < 0.9);
  points_per_pitch_ = 16 * static_cast<int>(std::ceil((2 * band_per_pitch_ + 0.1) / 16));
}

ChainScope ImageChain::scope() const {
  return {.spec = spec_, .plan = plan_, .wavelengths = accuracy_.wavelengths, .motion = motion_};
}

FrequencyLattice ImageChain::lattice(double size_pitch) const {
  // Diffraction tails fall as r^-3. Their energy is proportional to the area and to the width of the blur spot in
  // pitches: wrapped signal 1.6e-4 at period 16, for size 2.6 and a spot of 13 um x f/1 on 47.5 um.
  const double relative_area = std::max(1.0, std::pow(size_pitch / 2.6, 2));
  // The spread along the axis with the smaller pitch, in its pitches.
  const double stretch = std::max(1.0, 1 / spec_.pitch_aspect());
  const double spot = stretch * spec_.wavelength_max_um * spec_.f_number / spec_.pitch_um;
  const double relative_spot = plan_.simulates(Effect::diffraction) ? std::max(1.0, spot / (13 / 47.5)) : 1.0;
  const double tails = 16 * std::cbrt(1.6e-4 * relative_area * relative_spot / accuracy_.wrap_tolerance);
  // Copies of a halo that is wider than the period add up to a uniform level of share x area / period^2.
  const double halo =
      std::min(stretch * spread_.halo_reach, size_pitch * std::sqrt(spread_.halo_share / accuracy_.wrap_tolerance));
  const double body = 2 * size_pitch + 16 + stretch * spread_.period + halo;
  const int period = 8 * static_cast<int>(std::ceil(std::max(tails, body) / 8 - 1e-9));
  return {.period = period, .band = static_cast<int>(std::floor(band_per_pitch_ * period))};
}

std::shared_ptr<const FilterTable> ImageChain::filter(const FrequencyLattice& lattice) const {
  const std::scoped_lock lock(mutex_);
  auto& slot = filters_[lattice.period];
  if (slot == nullptr) slot = std::make_shared<const FilterTable>(lattice, transfer_on(lattice));
  return slot;
}

/// With sequential readout the samples are those of the image at M p, M = [[1, -a], [0, 1 - b]], (a, b) the slope. The
/// spectrum is that of the shape at M^-1 p, times the transfer function at M^-T f. Both are exact.
TransferFunction ImageChain::transfer_on(const FrequencyLattice& lattice) const {
  if (readout_slope_ == cv::Point2d(0, 0)) return tabulated_transfer(lattice, scope());
  return [transfer = sensor_transfer(spec_, plan_, accuracy_.wavelengths, motion_), slope = readout_slope_](
             double u, double w) { return transfer(u, (w + slope.x * u) / (1 - slope.y)); };
}

Polygon ImageChain::read_out(const Polygon& shape_pitch) const {
  Polygon moved = shape_pitch;
  for (auto& corner : moved) corner = as_read_out(corner, readout_slope_, 0);
  return moved;
}

PolygonImage ImageChain::image(const Polygon& shape_pitch) const {
  const Polygon shape = read_out(shape_pitch);
  const double size = std::max(std::sqrt(area(shape)), reach(shape));
  return {shape, *filter(lattice(size))};
}

ImageChain::InfinitePlane ImageChain::infinite_plane(const Polygon& whole_shape_pitch, cv::Point2d first, double step,
                                                     cv::Size size) const {
  const Polygon shape_pitch = read_out(whole_shape_pitch);
  const double aspect = spec_.pitch_aspect();
  const cv::Point2d half_window(0.5 * step * (size.width - 1), 0.5 * step * (size.height - 1));
  const cv::Point2d centre = first + half_window;
  // Far away the spot is round in space, not on the detectors.
  const Polygon shape = in_space(placed(shape_pitch, 1, -centre), aspect);
  const double half_width = std::max(half_window.x, aspect * half_window.y) + near_field + spread_.window;
  if (reach(shape) <= std::numbers::sqrt2 * half_width) return extrapolated(shape_pitch, first, step, size);
  const Polygon near = in_space(clipped(shape, half_width), 1 / aspect);
  InfinitePlane out{cv::Mat1d::zeros(size), 0};
  if (area(near) > 0) out = extrapolated(near, first - centre, step, size);
  add_far_field(out, shape, first - centre, step, half_width);
  return out;
}

/// The transfer function of a diffraction spot has a cusp at zero, 1 - a |f|. Far away the spot therefore falls as a /
/// (4 pi^2 r^3), the inverse transform of -a |f|. The average over detector and aberration, with variance v per axis,
/// changes this by the fraction 9 v / (2 r^2).
void ImageChain::add_far_field(InfinitePlane& near, const Polygon& shape, cv::Point2d first, double step,
                               double half_width) const {
  const OpticsMtf optics(scope());
  // In cycles per pitch; the next terms, those of a halo among them, are of second and third order.
  const double small = 1e-4 / (1 + spread_.halo_reach * spread_.halo_reach);
  const double cusp = (1 - optics(small)) / small / (4 * std::numbers::pi * std::numbers::pi);
  double largest = 0;
  for (int row = 0; row < near.values.rows; ++row) {
    for (int column = 0; column < near.values.cols; ++column) {
      const cv::Point2d place = first + step * cv::Point2d(column, row);
      const double added = cusp * far_integral(shape, {place.x, spec_.pitch_aspect() * place.y}, half_width);
      near.values(row, column) += added;
      largest = std::max(largest, added);
    }
  }
  near.max_error_estimate += largest * (9 * (spread_.variance + 0.1) / (near_field * near_field) + 1e-5) +
                             spread_.far * std::pow(half_width, -5.0 / 3);
}

ImageChain::InfinitePlane ImageChain::extrapolated(const Polygon& shape_pitch, cv::Point2d first, double step,
                                                   cv::Size size) const {
  const cv::Point2d far(std::abs(first.x) + step * size.width, std::abs(first.y) + step * size.height);
  const double extent = std::max({reach(shape_pitch), far.x / 2, far.y / 2});
  const FrequencyLattice small = lattice(extent);
  const FrequencyLattice large{.period = 2 * small.period,
                               .band = static_cast<int>(std::floor(band_per_pitch_ * 2 * small.period))};
  const cv::Mat1d a = PolygonImage(shape_pitch, *filter(small)).sample(first, step, size);
  const cv::Mat1d b = PolygonImage(shape_pitch, *filter(large)).sample(first, step, size);
  InfinitePlane out;
  out.values = (8.0 * b - a) / 7.0;
  double difference = 0;
  for (int row = 0; row < a.rows; ++row) {
    for (int column = 0; column < a.cols; ++column)
      difference = std::max(difference, std::abs(a(row, column) - b(row, column)));
  }
  // The next term of the series falls as P^-5, the extrapolated one as P^-3. The remaining error is a small part of the
  // correction itself.
  out.max_error_estimate = difference / 7;
  return out;
}

}  // namespace todbench
