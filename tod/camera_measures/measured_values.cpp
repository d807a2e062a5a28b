// SPDX-License-Identifier: GPL-3.0-or-later
// What the records of the measures say of themselves.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "tod/camera_measures/camera_measures.h"
#include "tod/measures/pixel_noise.h"

namespace todbench {

Estimate GeometryMeasure::ifov_mrad(EdgeAxis axis) const {
  const Estimate& mm = axis == EdgeAxis::x ? geometry.mm_per_px_x : geometry.mm_per_px_y;
  return {mm.value / distance_m, mm.low / distance_m, mm.high / distance_m};
}

namespace {

/// Distortion with an interval for places beyond the plate. A plate within q of the corner does not show a term of
/// fifth order: it is taken to be at most half of that of third order, either way, and weighted with 1 - q^2.
Estimate continued(const PlateGeometry& geometry) {
  constexpr double fifth_order = 0.5;
  const Estimate& k = geometry.distortion_percent;
  const double q = std::min(1.0, geometry.farthest_px / geometry.corner_px);
  const double unseen = fifth_order * std::max(std::abs(k.low), std::abs(k.high)) * (1 - q * q);
  return {k.value, k.value - std::hypot(k.value - k.low, unseen), k.value + std::hypot(k.high - k.value, unseen)};
}

}  // namespace

Estimate GeometryMeasure::field_of_view_deg(EdgeAxis axis) const {
  // In pixels along x, as the distortion.
  const double unit = axis == EdgeAxis::x ? 1 : pixel_aspect;
  const double half_px = 0.5 * (axis == EdgeAxis::x ? picture.width : picture.height) * unit;
  const auto angle_deg = [&](double mrad_per_px, double distortion_percent) {
    // Place without distortion that the lens moves to the border: r (1 + k (r / R)^2) = half_px.
    double r = half_px;
    constexpr int rounds = 50;  // the distortion of a lens converges in ten
    for (int i = 0; i < rounds; ++i)
      r = half_px / (1 + 0.01 * distortion_percent * std::pow(r / geometry.corner_px, 2));
    return 2 * std::atan(1e-3 * mrad_per_px * (r / unit)) * 180 / std::numbers::pi;
  };
  const Estimate ifov = ifov_mrad(axis), k = continued(geometry);
  const double value = angle_deg(ifov.value, k.value);
  return {value, value - std::hypot(value - angle_deg(ifov.low, k.value), value - angle_deg(ifov.value, k.high)),
          value + std::hypot(angle_deg(ifov.high, k.value) - value, angle_deg(ifov.value, k.low) - value)};
}

Estimate GeometryMeasure::aspect_ratio() const {
  const Estimate &x = geometry.mm_per_px_x, &y = geometry.mm_per_px_y;
  const double value = x.value / y.value;
  return {value, value * (1 - std::hypot(1 - x.low / x.value, y.high / y.value - 1)),
          value * (1 + std::hypot(x.high / x.value - 1, 1 - y.low / y.value))};
}

const BarsCtf* CtfMeasure::stated(EdgeAxis axis) const {
  const BarsCtf* nearest = nullptr;
  const auto apart = [&](const BarsCtf& group) { return std::abs(group.frequency_per_pitch - frequency_per_pitch); };
  for (const BarsCtf& group : bars.groups) {
    if (group.axis == axis && (nearest == nullptr || apart(group) < apart(*nearest))) nearest = &group;
  }
  return nearest;
}

std::optional<ComponentEstimate> CameraMeasures::temporal_variance_k2() const {
  if (!noise) return std::nullopt;
  return temporal_variance(noise->table);
}

std::optional<double> PlatePicture::residual_over_noise() const {
  if (!(seen.temporal_noise_k > 0) || seen.frames < 1) return std::nullopt;
  return residual_k / (seen.temporal_noise_k / std::sqrt(seen.frames));
}

double TransferMeasure::slope_half_width() const {
  return quantile(distribution::StudentsT(line.degrees_of_freedom), 0.975) * line.slope_u;
}

Estimate SourceSizeMeasure::slope() const {
  const double slope = effect.reference_k / said_delta_t_k;
  const double half = std::abs(normal_z95 * effect.reference_u_k / said_delta_t_k);
  return {slope, slope - half, slope + half};
}

std::optional<Estimate> CameraMeasures::netd_extended_k() const {
  if (!noise || !source || !(source->slope().value > 0)) return std::nullopt;
  if (noise->noise_counts && *noise->noise_counts < least_measurable_noise_counts) return std::nullopt;
  const ComponentEstimate variance = *temporal_variance_k2();
  if (!(variance.variance > 0)) return std::nullopt;
  const Estimate slope = source->slope();
  const double netd = std::sqrt(variance.variance) / slope.value;
  const double half = netd * std::hypot(0.25 * (variance.high - variance.low) / variance.variance,
                                        (slope.high - slope.low) / (2 * slope.value));
  return Estimate{netd, netd - half, netd + half};
}

std::optional<double> CameraMeasures::netd_k() const {
  if (!noise || !transfer || !(transfer->line.slope > 0)) return std::nullopt;
  if (noise->noise_counts && *noise->noise_counts < least_measurable_noise_counts) return std::nullopt;
  return std::sqrt(std::max(0.0, temporal_variance_k2()->variance)) / transfer->line.slope;
}

std::optional<double> CameraMeasures::netd_relative_half_width() const {
  const auto netd = netd_k();
  if (!netd || !(*netd > 0)) return std::nullopt;
  const ComponentEstimate variance = *temporal_variance_k2();
  const double of_noise = 0.25 * (variance.high - variance.low) / variance.variance;
  return std::hypot(of_noise, transfer->slope_half_width() / transfer->line.slope);
}

}  // namespace todbench
