// Optics and detector in the frequency domain, in cycles per detector pitch.
#pragma once

#include <complex>
#include <opencv2/core/types.hpp>
#include <vector>

#include "hvs/shape/polygon_image.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Diffraction of a circular aperture at one wavelength: (2/pi)(acos X - X sqrt(1 - X^2)), X = rho lambda N / pitch
/// (Goodman, 3rd ed., 6-31).
[[nodiscard]] double diffraction_mtf(double rho_per_pitch, double wavelength_um, double f_number, double pitch_um);

/// A wavelength with its weight; weights sum to 1.
struct WavelengthNode {
  double wavelength_um = 0, weight = 0;
};
/// Gauss-Legendre nodes over the band, weighted with dL/dT of a black body (Planck, power units). `count` 1..64; 1 is
/// the weighted mean.
[[nodiscard]] std::vector<WavelengthNode> wavelength_nodes(const SensorSpec& spec, int count);

/// Optics as a function of radial frequency: polychromatic diffraction and aberration, each as the plan says.
class OpticsMtf {
 public:
  OpticsMtf(const SensorSpec& spec, const SensorPlan& plan, int wavelengths);
  [[nodiscard]] double operator()(double rho_per_pitch) const;
  /// Above this frequency the optics pass nothing, in cycles per pitch; infinity without diffraction.
  [[nodiscard]] double cut_off_per_pitch() const;

 private:
  std::vector<WavelengthNode> nodes_;
  double f_number_, pitch_um_, sigma_pitch_;
  bool diffraction_;
};

/// Square detector: sinc(u d) sinc(w d), sinc(x) = sin(pi x) / (pi x), d = detector over pitch.
[[nodiscard]] double detector_mtf(double u_per_pitch, double w_per_pitch, double detector_pitch_ratio);

/// A bolometer with time constant tau under a target of velocity v, smear s = v tau in pitches: the detector
/// remembers exp(-t / tau) / tau of what it saw, so the tail is behind the target: 1 / (1 - 2 pi i f.s), times
/// exp(-2 pi i f.s), which takes the mean lag out: the target is tracked.
[[nodiscard]] std::complex<double> motion_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d smear_pitch);
/// v tau in pitches; zero where the plan leaves motion out.
[[nodiscard]] cv::Point2d smear_pitch(const SensorSpec& spec, const SensorPlan& plan, SceneMotion motion);

/// Optics, detector and motion as planned.
[[nodiscard]] TransferFunction sensor_transfer(const SensorSpec& spec, const SensorPlan& plan, int wavelengths,
                                               SceneMotion motion = {});

}  // namespace todbench
