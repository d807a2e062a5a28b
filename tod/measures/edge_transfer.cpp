#include "tod/measures/edge_transfer.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "acquisition/core/distributions.h"

namespace todbench {
namespace {

using Spectrum = std::vector<std::complex<double>>;

/// Points of the derivative for each cell: of a cubic spline with four knots a pitch nothing is left above 8 cycles per
/// pitch, which 16 points a pitch could take for something else.
constexpr int points_per_cell = 4;

/// What each point of the derivative adds to each frequency.
class Transform {
 public:
  Transform(const SplineGrid& grid, const EdgeWindow& window, const std::vector<double>& frequencies)
      : frequencies_(frequencies.size()) {
    for (int i = 0; i < grid.cells * points_per_cell; ++i) {
      const double t = grid.start + (i + 0.5) * grid.step / points_per_cell;
      const double weight = window.at(t);
      if (weight > 0) points_.push_back(t), weights_.push_back(weight);
    }
    for (const double frequency : frequencies) {
      for (std::size_t i = 0; i < points_.size(); ++i)
        factors_.push_back(std::polar(weights_[i], -2 * std::numbers::pi * frequency * points_[i]));
    }
  }
  /// Transform over its value at frequency 0, which is the first.
  [[nodiscard]] Spectrum of(const Spline& profile) const {
    std::vector<double> slopes;
    for (const double t : points_) slopes.push_back(profile.slope(t));
    Spectrum spectrum;
    for (std::size_t k = 0; k < frequencies_; ++k) {
      double re = 0, im = 0;
      const auto* factor = &factors_[k * points_.size()];
      for (std::size_t i = 0; i < slopes.size(); ++i)
        re += factor[i].real() * slopes[i], im += factor[i].imag() * slopes[i];
      spectrum.emplace_back(re, im);
    }
    const std::complex<double> whole = spectrum.front();
    for (auto& value : spectrum) value /= whole;
    return spectrum;
  }

 private:
  std::size_t frequencies_;
  std::vector<double> points_, weights_;
  std::vector<std::complex<double>> factors_;
};

/// Rounding counts fully from here on: the sum of the derivative, at frequency 0, does not change.
constexpr double rounding_full_from_per_pitch = 0.05;

/// What the method itself may be wrong by: twice the largest error over 30 blurs and 3 angles without noise, and more
/// beyond half a cycle per pitch.
double method_error(double frequency_per_pitch) {
  return 0.0003 * std::min(1.0, frequency_per_pitch / 0.1) + 0.004 * std::max(0.0, frequency_per_pitch - 0.5);
}

}  // namespace

double EdgeWindow::at(double t) const {
  const double distance = std::abs(t);
  if (distance <= flat) return 1;
  if (distance >= end) return 0;
  return 0.5 * (1 + std::cos(std::numbers::pi * (distance - flat) / (end - flat)));
}

EdgeGroups grouped(const std::vector<EdgeSample>& samples, const SplineGrid& grid, int rows) {
  const int count = std::clamp(rows / 4, 5, 20);
  EdgeGroups out{SplineSums(grid), std::vector<SplineSums>(static_cast<std::size_t>(count), SplineSums(grid))};
  for (const EdgeSample& sample : samples)
    out.groups[static_cast<std::size_t>(sample.row * count / rows)].add(sample.t, sample.value);
  for (const SplineSums& group : out.groups) out.all += group;
  return out;
}

EdgeTransfer edge_transfer(const EdgeGroups& groups, const EdgeWindow& window,
                           const std::vector<double>& frequency_per_pitch, double rounding) {
  const auto profile = groups.all.solve();
  if (!profile) return {};
  const Transform transform(profile->grid, window, frequency_per_pitch);
  const Spectrum whole = transform.of(*profile);
  const double count = static_cast<double>(groups.groups.size());
  // Parts along the phasor of the whole change its length, parts across it only its direction.
  std::vector<double> along(whole.size()), along_square(whole.size()), across(whole.size()),
      across_square(whole.size());
  for (const SplineSums& group : groups.groups) {
    SplineSums without = groups.all;
    without -= group;
    const auto part = without.solve();
    if (!part) return {};
    const Spectrum spectrum = transform.of(*part);
    for (std::size_t k = 0; k < whole.size(); ++k) {
      const double length = std::abs(whole[k]);
      const auto turned = length > 0 ? spectrum[k] * std::conj(whole[k]) / length : spectrum[k];
      along[k] += turned.real(), along_square[k] += turned.real() * turned.real();
      across[k] += turned.imag(), across_square[k] += turned.imag() * turned.imag();
    }
  }
  const auto variance = [&](double sum, double square) {
    return std::max(0.0, (square - sum * sum / count) * (count - 1) / count);
  };
  const double t = distribution::quantile(distribution::StudentsT(count - 1), 0.975);
  EdgeTransfer found;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const double noise = variance(across[k], across_square[k]);
    const double mtf = std::sqrt(std::max(0.0, std::norm(whole[k]) - noise));
    const double rounded = rounding * std::min(1.0, frequency_per_pitch[k] / rounding_full_from_per_pitch);
    const double half =
        std::hypot(t * std::sqrt(variance(along[k], along_square[k])), method_error(frequency_per_pitch[k]), rounded);
    found.mtf.push_back(mtf);
    found.low.push_back(std::max(0.0, mtf - half));
    found.high.push_back(mtf + half);
  }
  return found;
}

}  // namespace todbench
