#include "sim_devices/sensor/transfer_functions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hvs/shape/gauss_legendre.h"

namespace todbench {
namespace {

constexpr double second_radiation_constant_um_k = 14387.768775;  // hc/k, exact in SI 2019, to 10 digits

/// dL/dT of a black body over wavelength, up to a factor: lambda^-6 e^x / (e^x - 1)^2, x = c2 / (lambda T).
double planck_derivative(double wavelength_um, double temperature_k) {
  const double x = second_radiation_constant_um_k / (wavelength_um * temperature_k);
  const double e = std::exp(-x);
  const double denominator = std::expm1(-x);
  return std::pow(wavelength_um, -6) * e / (denominator * denominator);
}

double sinc(double x) {
  const double y = std::numbers::pi * x;
  return std::abs(y) < 1e-8 ? 1.0 : std::sin(y) / y;
}

}  // namespace

double diffraction_mtf(double rho_per_pitch, double wavelength_um, double f_number, double pitch_um) {
  const double x = std::abs(rho_per_pitch) * wavelength_um * f_number / pitch_um;
  if (x >= 1) return 0;
  return 2 / std::numbers::pi * (std::acos(x) - x * std::sqrt(1 - x * x));
}

std::vector<WavelengthNode> wavelength_nodes(const SensorSpec& spec, int count) {
  const double middle = (spec.wavelength_min_um + spec.wavelength_max_um) / 2;
  const double half = (spec.wavelength_max_um - spec.wavelength_min_um) / 2;
  std::vector<WavelengthNode> nodes;
  double sum = 0;
  for (const auto& [x, weight] : gauss_legendre(count == 1 ? 16 : count)) {
    const double wavelength = middle + half * x;
    nodes.push_back({wavelength, weight * planck_derivative(wavelength, spec.scene_temperature_k)});
    sum += nodes.back().weight;
  }
  double mean = 0;
  for (auto& node : nodes) {
    node.weight /= sum;
    mean += node.weight * node.wavelength_um;
  }
  if (count == 1) return {{mean, 1.0}};
  return nodes;
}

OpticsMtf::OpticsMtf(const SensorSpec& spec, const SensorPlan& plan, int wavelengths)
    : nodes_(wavelength_nodes(spec, plan.simulates(Effect::spectral_band) ? wavelengths : 1)),
      f_number_(spec.f_number),
      pitch_um_(spec.pitch_um),
      sigma_pitch_(plan.simulates(Effect::aberration) ? spec.aberration_sigma_pitch : 0),
      diffraction_(plan.simulates(Effect::diffraction)) {}

double OpticsMtf::operator()(double rho_per_pitch) const {
  double value = 1;
  if (diffraction_) {
    value = 0;
    for (const auto& node : nodes_)
      value += node.weight * diffraction_mtf(rho_per_pitch, node.wavelength_um, f_number_, pitch_um_);
  }
  if (sigma_pitch_ > 0) {
    const double exponent = std::numbers::pi * sigma_pitch_ * rho_per_pitch;
    value *= std::exp(-2 * exponent * exponent);
  }
  return value;
}

double OpticsMtf::cut_off_per_pitch() const {
  if (!diffraction_) return std::numeric_limits<double>::infinity();
  const auto shortest = std::min_element(
      nodes_.begin(), nodes_.end(), [](const auto& a, const auto& b) { return a.wavelength_um < b.wavelength_um; });
  return pitch_um_ / (shortest->wavelength_um * f_number_);
}

double detector_mtf(double u_per_pitch, double w_per_pitch, double detector_pitch_ratio) {
  return sinc(u_per_pitch * detector_pitch_ratio) * sinc(w_per_pitch * detector_pitch_ratio);
}

std::complex<double> motion_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d smear_pitch) {
  const double phase = 2 * std::numbers::pi * (u_per_pitch * smear_pitch.x + w_per_pitch * smear_pitch.y);
  return std::polar(1.0, -phase) / std::complex<double>(1, -phase);
}

cv::Point2d smear_pitch(const SensorSpec& spec, const SensorPlan& plan, SceneMotion motion) {
  if (!plan.simulates(Effect::motion)) return {0, 0};
  const double pitches_per_mrad_s = spec.time_constant_ms * 1e-3 / spec.ifov_mrad();
  return {motion.x_mrad_s * pitches_per_mrad_s, motion.y_mrad_s * pitches_per_mrad_s};
}

TransferFunction sensor_transfer(const SensorSpec& spec, const SensorPlan& plan, int wavelengths, SceneMotion motion) {
  const OpticsMtf optics(spec, plan, wavelengths);
  const double ratio = plan.simulates(Effect::detector) ? spec.detector_pitch_ratio() : 0;
  const cv::Point2d smear = smear_pitch(spec, plan, motion);
  if (smear == cv::Point2d(0, 0)) {
    return [optics, ratio](double u, double w) -> std::complex<double> {
      return optics(std::hypot(u, w)) * detector_mtf(u, w, ratio);
    };
  }
  return [optics, ratio, smear](double u, double w) -> std::complex<double> {
    return optics(std::hypot(u, w)) * detector_mtf(u, w, ratio) * motion_transfer(u, w, smear);
  };
}

}  // namespace todbench
