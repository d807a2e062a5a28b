// Image formation in the frequency domain, in cycles per detector pitch: the product of the rows that the plan
// simulates.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "hvs/shape/polygon_image.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

/// Optics as a function of radial frequency: the rows of stage::Optics, each as the plan says.
class OpticsMtf {
 public:
  explicit OpticsMtf(const ChainScope& scope);
  OpticsMtf(const SensorSpec& spec, const SensorPlan& plan, int wavelengths)
      : OpticsMtf(ChainScope{.spec = spec, .plan = plan, .wavelengths = wavelengths}) {}
  [[nodiscard]] double operator()(double rho_per_pitch) const;

 private:
  std::vector<std::function<double(double)>> factors_;
};

/// The footprint along one axis: the rows of stage::Footprint, each as the plan says.
class FootprintMtf {
 public:
  explicit FootprintMtf(const ChainScope& scope);
  [[nodiscard]] double operator()(double f_per_pitch) const;

 private:
  SensorSpec spec_;
  std::vector<stage::Footprint> factors_;
};

/// The rows of stage::Transfer that have something to do in this scene.
[[nodiscard]] std::vector<TransferFunction> other_transfers(const ChainScope& scope);

/// All of image formation; readout row by row has no transfer, it moves samples.
[[nodiscard]] TransferFunction sensor_transfer(const SensorSpec& spec, const SensorPlan& plan, int wavelengths,
                                               SceneMotion motion = {});
/// The same at the frequencies m / period, |m| <= band, to the last bit. Optics know only the radius and the footprint
/// is a product over the axes, so an eighth of the plane and one axis are computed.
[[nodiscard]] TransferFunction tabulated_transfer(FrequencyLattice lattice, const ChainScope& scope);

/// What the target moves from one row of samples to the next, in pitches: the rows of stage::Readout, added up.
[[nodiscard]] cv::Point2d readout_slope_of(const ChainScope& scope);

/// What the simulated stages of image formation spread, added up.
[[nodiscard]] Spread spread_of(const ChainScope& scope);

}  // namespace todbench
