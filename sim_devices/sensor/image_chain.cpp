#include "sim_devices/sensor/image_chain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim_devices/sensor/transfer_functions.h"

namespace todbench {
namespace {

/// Highest frequency that matters, in cycles per pitch: where the optics end, or where aberration has taken the signal
/// below the tolerance. Without either the spectrum of a sharp shape never ends; 16 cycles per pitch then leave an
/// error near 1/(pi^2 16) at edges.
double needed_band(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy) {
  double band = 16;
  if (plan.simulates(Effect::diffraction))
    band = std::min(band, spec.pitch_um / (spec.wavelength_min_um * spec.f_number));
  if (plan.simulates(Effect::aberration) && spec.aberration_sigma_pitch > 0) {
    const double gaussian =
        std::sqrt(-std::log(accuracy.band_tolerance) / 2) / (std::numbers::pi * spec.aberration_sigma_pitch);
    band = std::min(band, std::max(gaussian, 0.5));
  }
  return band;
}

/// Largest distance of a vertex from the origin.
double reach(const Polygon& shape) {
  double largest = 0;
  for (const auto& v : shape) largest = std::max(largest, std::hypot(v.x, v.y));
  return largest;
}

/// sensor_transfer() at the frequencies m / period, |m| <= band, to the last bit. Optics know only the radius and the
/// detector is a product over the axes, so an eighth of the plane and one axis are computed.
TransferFunction tabulated_transfer(FrequencyLattice lattice, const SensorSpec& spec, const SensorPlan& plan,
                                    int wavelengths, cv::Point2d smear) {
  const OpticsMtf optics(spec, plan, wavelengths);
  const double ratio = plan.simulates(Effect::detector) ? spec.detector_pitch_ratio() : 0;
  const double period = lattice.period;
  const auto count = static_cast<std::size_t>(lattice.band) + 1;
  std::vector<double> radial, axis;  // radial: [larger][smaller], a triangle
  radial.reserve(count * (count + 1) / 2);
  for (std::size_t larger = 0; larger < count; ++larger) {
    const double u = static_cast<double>(larger) / period;
    axis.push_back(detector_mtf(u, 0, ratio));
    for (std::size_t smaller = 0; smaller <= larger; ++smaller)
      radial.push_back(optics(std::hypot(u, static_cast<double>(smaller) / period)));
  }
  const auto still = [radial = std::move(radial), axis = std::move(axis), period](double u, double w) {
    const auto m = static_cast<std::size_t>(std::llround(std::abs(u) * period));
    const auto n = static_cast<std::size_t>(std::llround(std::abs(w) * period));
    const std::size_t larger = std::max(m, n);
    return std::complex<double>(radial[larger * (larger + 1) / 2 + std::min(m, n)] * (axis[m] * axis[n]));
  };
  if (smear == cv::Point2d(0, 0)) return still;
  return [still, smear](double u, double w) { return still(u, w) * motion_transfer(u, w, smear); };
}

}  // namespace

ImageChain::ImageChain(SensorSpec spec, SensorPlan plan, Accuracy accuracy, SceneMotion motion)
    : spec_(std::move(spec)),
      plan_(std::move(plan)),
      accuracy_(accuracy),
      smear_pitch_(smear_pitch(spec_, plan_, motion)),
      band_per_pitch_(needed_band(spec_, plan_, accuracy_)) {
  points_per_pitch_ = 16 * static_cast<int>(std::ceil((2 * band_per_pitch_ + 0.1) / 16));
}

FrequencyLattice ImageChain::lattice(double size_pitch) const {
  // Diffraction tails fall as r^-3 and carry energy in proportion to the area: wrapped signal 1.6e-4 at period 16 for
  // size 2.6.
  const double relative_area = std::max(1.0, std::pow(size_pitch / 2.6, 2));
  const double tails = 16 * std::cbrt(1.6e-4 * relative_area / accuracy_.wrap_tolerance);
  // The tail of a moving target has fallen to e^-14, 1e-6, after fourteen smears.
  const double body = 2 * size_pitch + 16 + 14 * std::hypot(smear_pitch_.x, smear_pitch_.y);
  const int period = 8 * static_cast<int>(std::ceil(std::max(tails, body) / 8 - 1e-9));
  return {.period = period, .band = static_cast<int>(std::floor(band_per_pitch_ * period))};
}

std::shared_ptr<const FilterTable> ImageChain::filter(const FrequencyLattice& lattice) const {
  const std::scoped_lock lock(mutex_);
  auto& slot = filters_[lattice.period];
  if (slot == nullptr)
    slot = std::make_shared<const FilterTable>(
        lattice, tabulated_transfer(lattice, spec_, plan_, accuracy_.wavelengths, smear_pitch_));
  return slot;
}

PolygonImage ImageChain::image(const Polygon& shape_pitch) const {
  const double size = std::max(std::sqrt(area(shape_pitch)), reach(shape_pitch));
  return {shape_pitch, *filter(lattice(size))};
}

ImageChain::InfinitePlane ImageChain::infinite_plane(const Polygon& shape_pitch, cv::Point2d first, double step,
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
  // The next term of the series falls as P^-5, the extrapolated one as P^-3: what remains is a small part of the
  // correction itself.
  out.max_error_estimate = difference / 7;
  return out;
}

}  // namespace todbench
