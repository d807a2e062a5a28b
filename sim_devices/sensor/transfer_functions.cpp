// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/transfer_functions.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace todbench {

OpticsMtf::OpticsMtf(const ChainScope& scope) {
  for (const Effect effect : all_effects) {
    if (!scope.plan.simulates(effect)) continue;
    if (const auto* optics = std::get_if<stage::Optics>(&row_of(effect).stage))
      factors_.push_back(optics->factor(scope));
  }
}

double OpticsMtf::operator()(double rho_per_pitch) const {
  double value = 1;
  for (const auto& factor : factors_) value *= factor(rho_per_pitch);
  return value;
}

FootprintMtf::FootprintMtf(const ChainScope& scope) : spec_(scope.spec) {
  for (const Effect effect : all_effects) {
    if (!scope.plan.simulates(effect)) continue;
    if (const auto* own = std::get_if<stage::Footprint>(&row_of(effect).stage)) factors_.push_back(*own);
  }
}

double FootprintMtf::operator()(double f_per_pitch, PitchAxis axis) const {
  double value = 1;
  for (const auto& own : factors_) value *= own.factor(f_per_pitch, spec_, axis);
  return value;
}

std::vector<TransferFunction> other_transfers(const ChainScope& scope) {
  std::vector<TransferFunction> transfers;
  for (const Effect effect : all_effects) {
    const auto* own = std::get_if<stage::Transfer>(&row_of(effect).stage);
    if (own == nullptr || !scope.plan.simulates(effect)) continue;
    if (TransferFunction transfer = own->factor(scope)) transfers.push_back(std::move(transfer));
  }
  return transfers;
}

TransferFunction sensor_transfer(const SensorSpec& spec, const SensorPlan& plan, int wavelengths, SceneMotion motion) {
  const ChainScope scope{.spec = spec, .plan = plan, .wavelengths = wavelengths, .motion = motion};
  return [optics = OpticsMtf(scope), footprint = FootprintMtf(scope), others = other_transfers(scope),
          aspect = spec.pitch_aspect()](double u, double w) {
    std::complex<double> value =
        optics(std::hypot(u, w / aspect)) * (footprint(u, PitchAxis::x) * footprint(w, PitchAxis::y));
    for (const auto& other : others) value *= other(u, w);
    return value;
  };
}

TransferFunction tabulated_transfer(FrequencyLattice lattice, const ChainScope& scope) {
  if (scope.spec.pitch_aspect() != 1) return sensor_transfer(scope.spec, scope.plan, scope.wavelengths, scope.motion);
  const OpticsMtf optics(scope);
  const FootprintMtf footprint(scope);
  const double period = lattice.period;
  const auto count = static_cast<std::size_t>(lattice.band) + 1;
  std::vector<double> radial, along_x, along_y;  // radial: [larger][smaller], a triangle
  radial.reserve(count * (count + 1) / 2);
  for (std::size_t larger = 0; larger < count; ++larger) {
    const double u = static_cast<double>(larger) / period;
    along_x.push_back(footprint(u, PitchAxis::x));
    along_y.push_back(footprint(u, PitchAxis::y));
    for (std::size_t smaller = 0; smaller <= larger; ++smaller)
      radial.push_back(optics(std::hypot(u, static_cast<double>(smaller) / period)));
  }
  return [radial = std::move(radial), along_x = std::move(along_x), along_y = std::move(along_y),
          others = other_transfers(scope), period](double u, double w) {
    const auto m = static_cast<std::size_t>(std::llround(std::abs(u) * period));
    const auto n = static_cast<std::size_t>(std::llround(std::abs(w) * period));
    const std::size_t larger = std::max(m, n);
    std::complex<double> value = radial[larger * (larger + 1) / 2 + std::min(m, n)] * (along_x[m] * along_y[n]);
    for (const auto& other : others) value *= other(u, w);
    return value;
  };
}

double highest_frequency(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy) {
  double band = 16;
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.band != nullptr && plan.simulates(effect)) band = std::min(band, row.band(spec, accuracy));
  }
  // In cycles per pitch of the axis with the larger one.
  return band * std::max(1.0, spec.pitch_aspect());
}

cv::Point2d readout_slope_of(const ChainScope& scope) {
  cv::Point2d slope(0, 0);
  for (const Effect effect : all_effects) {
    const auto* own = std::get_if<stage::Readout>(&row_of(effect).stage);
    if (own != nullptr && scope.plan.simulates(effect)) slope += own->pitches_per_row(scope.spec, scope.motion);
  }
  return slope;
}

Spread spread_of(const ChainScope& scope) {
  Spread sum;
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.spread == nullptr || !scope.plan.simulates(effect)) continue;
    const Spread own = row.spread(scope);
    sum.period += own.period;
    sum.window += own.window;
    sum.variance += own.variance;
    sum.far += own.far;
    sum.halo_share += own.halo_share;
    sum.halo_reach += own.halo_reach;
  }
  return sum;
}

}  // namespace todbench
