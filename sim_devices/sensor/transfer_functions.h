// SPDX-License-Identifier: GPL-3.0-or-later
// Image formation at the frequencies (u, w) in cycles per detector pitch of each axis: the product of the effects in
// the plan. Optics depend on the radius hypot(u, w / SensorSpec::pitch_aspect()), in cycles per pitch along x.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "hvs/shape/polygon_image.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

/// Transfer function of the optics over radial frequency: product of the planned rows with stage::Optics.
class OpticsMtf {
 public:
  explicit OpticsMtf(const ChainScope& scope);
  OpticsMtf(const SensorSpec& spec, const SensorPlan& plan, int wavelengths)
      : OpticsMtf(ChainScope{.spec = spec, .plan = plan, .wavelengths = wavelengths}) {}
  [[nodiscard]] double operator()(double rho_per_pitch) const;

 private:
  std::vector<std::function<double(double)>> factors_;
};

/// Transfer function of the footprint along one axis: product of the planned rows with stage::Footprint.
class FootprintMtf {
 public:
  explicit FootprintMtf(const ChainScope& scope);
  [[nodiscard]] double operator()(double f_per_pitch, PitchAxis axis) const;

 private:
  SensorSpec spec_;
  std::vector<stage::Footprint> factors_;
};

/// Returns the filters of the planned rows with stage::Transfer, without those that do not filter in this scene.
[[nodiscard]] std::vector<TransferFunction> other_transfers(const ChainScope& scope);

/// Returns the transfer function of the whole image formation. Sequential readout is not included, because it moves
/// samples.
[[nodiscard]] TransferFunction sensor_transfer(const SensorSpec& spec, const SensorPlan& plan, int wavelengths,
                                               SceneMotion motion = {});
/// Returns sensor_transfer() from a table at the frequencies m / period, |m| <= band, bit for bit. Optics depend only
/// on the radius, and the footprint is a product over the axes, so only an eighth of the plane and both axes are
/// computed. With different pitches along x and y no table is used.
[[nodiscard]] TransferFunction tabulated_transfer(FrequencyLattice lattice, const ChainScope& scope);

/// Returns the highest relevant frequency along either axis, in cycles per pitch: the cut-off of the optics, or the
/// frequency at which the optics have reduced the signal to the tolerance. If no planned effect limits the spectrum of
/// a sharp shape, the limit is 16 cycles per pitch, with an error near 1/(pi^2 16) at edges.
[[nodiscard]] double highest_frequency(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy);

/// Returns the distance that the target moves from one row of detectors to the next, in pitches: the sum over the
/// planned effects with stage::Readout.
[[nodiscard]] cv::Point2d readout_slope_of(const ChainScope& scope);

/// Returns the sum of the spreads of the planned stages of image formation.
[[nodiscard]] Spread spread_of(const ChainScope& scope);

}  // namespace todbench
