// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/edge_transfer.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

using Spectrum = std::vector<std::complex<double>>;

/// Points of the derivative per cell: the spectrum of a cubic spline with four knots a pitch vanishes above 8 cycles
/// per pitch, so that 16 points a pitch do not alias.
constexpr int points_per_cell = 4;

/// Contribution of each point of the derivative to each frequency.
class Transform {
 public:
  Transform(const SplineGrid& grid, const EdgeWindow& window, const std::vector<double>& frequencies)
      : frequencies_(frequencies.size()) {
    for (int i = 0; i < grid.cells * points_per_cell; ++i) {
      const double t = grid.start + (i + 0.5) * grid.step / points_per_cell;
      const double weight = window.at(t);
      if (weight > 0) points_.push_back(t), weights_.push_back(weight);
    }
    step_ = grid.step / points_per_cell;
    for (const double frequency : frequencies) {
      for (std::size_t i = 0; i < points_.size(); ++i)
        factors_.push_back(std::polar(weights_[i], -2 * std::numbers::pi * frequency * points_[i]));
    }
  }
  /// Transform of the derivative at each frequency.
  [[nodiscard]] Spectrum of(const Spline& profile) const {
    std::vector<double> slopes;
    for (const double t : points_) slopes.push_back(profile.slope(t));
    Spectrum spectrum;
    for (std::size_t k = 0; k < frequencies_; ++k) {
      double re = 0, im = 0;
      const auto* factor = &factors_[k * points_.size()];
      for (std::size_t i = 0; i < slopes.size(); ++i)
        re += factor[i].real() * slopes[i], im += factor[i].imag() * slopes[i];
      spectrum.push_back(std::complex<double>(re, im) * step_);
    }
    return spectrum;
  }

 private:
  std::size_t frequencies_;
  double step_ = 0;
  std::vector<double> points_, weights_;
  std::vector<std::complex<double>> factors_;
};

/// Full rounding error from this frequency on: the sum of the derivative, at frequency 0, does not change.
constexpr double rounding_full_from_per_pitch = 0.05;

/// Error of the method: twice the largest error over 30 blurs and 3 angles without noise, and more above half a cycle
/// per pitch; includes the shapes of the tails near the core.
double method_error(double frequency_per_pitch) {
  return 0.0005 * std::min(1.0, frequency_per_pitch / 0.05) + 0.004 * std::max(0.0, frequency_per_pitch - 0.5);
}

/// Error of the shapes of negative halos: 1.5 times the largest error over sharpened edges of a diffracting lens,
/// without shading, in 200 x 200 pixels with little noise.
constexpr double sharpened_error = 0.0015;

/// Place at which a rising profile passes the middle between its ends.
double middle_of(const Spline& profile) {
  const double half = 0.5 * (profile.value(profile.grid.start) + profile.value(profile.grid.end()));
  double low = profile.grid.start, high = profile.grid.end();
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (profile.value(middle) < half ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// For each unknown the difference between its transfer and the transform of its profile within the window, at each
/// frequency.
std::vector<Spectrum> beyond_window(const EdgeTails& tails, const Transform& transform,
                                    const std::vector<double>& frequencies) {
  Spline narrow = tails.columns[edge_tails::step];
  for (double& value : narrow.coefficients) value *= tails.orientation;
  const double middle = middle_of(narrow);
  std::vector<Spectrum> out;
  for (const Spline& column : tails.columns) {
    out.push_back(transform.of(column));
    for (auto& value : out.back()) value *= -tails.orientation;
  }
  for (std::size_t f = 0; f < frequencies.size(); ++f) {
    const auto transfer = tail_transfer(frequencies[f], tails.fit.bounds());
    const auto place = std::polar(1.0, -2 * std::numbers::pi * frequencies[f] * middle);
    for (std::size_t k = 0; k < transfer.size(); ++k) out[k][f] += transfer[k] * place;
  }
  return out;
}

/// The MTF as a function of the tails at one frequency, along the phase of the total.
struct AtFrequency {
  double seen = 0;
  std::vector<double> parts;
  std::array<double, edge_tails::first_shading> contrast_parts{};
  [[nodiscard]] double contrast(const std::vector<double>& x) const {
    double sum = 0;
    for (std::size_t k = 0; k < contrast_parts.size(); ++k) sum += contrast_parts[k] * x[k];
    return sum;
  }
  [[nodiscard]] double mtf(const std::vector<double>& x) const {
    double sum = seen;
    for (std::size_t k = 0; k < parts.size(); ++k) sum += parts[k] * x[k];
    return sum / contrast(x);
  }
  /// Its gradient.
  [[nodiscard]] std::vector<double> direction(const std::vector<double>& x) const {
    std::vector<double> out = parts;
    const double value = mtf(x), whole = contrast(x);
    for (std::size_t k = 0; k < contrast_parts.size(); ++k) out[k] -= value * contrast_parts[k];
    for (double& part : out) part /= whole;
    return out;
  }
};

/// Components along the phasor of the total change its length, components across it only its direction.
std::complex<double> turned(const std::complex<double>& value, const std::complex<double>& whole) {
  const double length = std::abs(whole);
  return length > 0 ? value * std::conj(whole) / length : value;
}

/// Variances of the spectrum along and across the phasor of the total (jackknife over the groups of lines).
struct SpectrumNoise {
  std::vector<double> along, across;
};

std::optional<SpectrumNoise> jackknife(const EdgeGroups& groups, const Transform& transform, const Spectrum& seen,
                                       const Spectrum& whole, double step) {
  const auto count = static_cast<double>(groups.groups.size());
  const std::vector<double> none(whole.size());
  SpectrumNoise sums{none, none}, squares{none, none};
  for (const SplineSums& group : groups.groups) {
    SplineSums without = groups.all;
    without -= group;
    const auto part = without.solve();
    if (!part) return std::nullopt;
    const Spectrum spectrum = transform.of(*part);
    for (std::size_t k = 0; k < whole.size(); ++k) {
      const auto value = turned((spectrum[k] - seen[k]) / step, whole[k]);
      sums.along[k] += value.real(), squares.along[k] += value.real() * value.real();
      sums.across[k] += value.imag(), squares.across[k] += value.imag() * value.imag();
    }
  }
  const auto variance = [&](double sum, double square) {
    return std::max(0.0, (square - sum * sum / count) * (count - 1) / count);
  };
  for (std::size_t k = 0; k < whole.size(); ++k) {
    squares.along[k] = variance(sums.along[k], squares.along[k]);
    squares.across[k] = variance(sums.across[k], squares.across[k]);
  }
  return squares;
}

/// Factor by which lines at places with this variance lower the measured MTF: two displaced fields, cos(pi f d) with d
/// twice the root, lower it most of all distributions near 1.
double displaced(double f, double variance) {
  const double angle = 2 * std::numbers::pi * f * std::sqrt(variance);
  constexpr double least = 0.1;
  return angle < std::numbers::pi / 2 ? std::max(std::cos(angle), least) : least;
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
                           const std::vector<double>& frequency_per_pitch, const EdgeTails& tails, double rounding,
                           double displacement_pitch2) {
  const auto profile = groups.all.solve();
  if (!profile) return {};
  const Transform transform(profile->grid, window, frequency_per_pitch);
  const std::vector<Spectrum> beyond = beyond_window(tails, transform, frequency_per_pitch);
  const std::vector<double>& stated = tails.fit.stated();
  const Spectrum seen = transform.of(*profile);
  Spectrum whole = seen;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    whole[k] /= tails.step;
    for (std::size_t i = 0; i < beyond.size(); ++i) whole[k] += stated[i] * beyond[i][k];
  }
  const auto noise = jackknife(groups, transform, seen, whole, tails.step);
  if (!noise) return {};
  const auto count = static_cast<double>(groups.groups.size());
  const double t = distribution::quantile(distribution::StudentsT(count - 1), 0.975);
  AtFrequency at;
  at.contrast_parts = tail_contrast(tails.fit.bounds());
  const double step = at.contrast(stated);
  EdgeTransfer found{{1}, {1}, {1}, {true}};
  for (std::size_t k = 1; k < whole.size(); ++k) {
    const double f = frequency_per_pitch[k];
    at.seen = turned(seen[k] / tails.step, whole[k]).real(), at.parts.clear();
    for (const Spectrum& part : beyond) at.parts.push_back(turned(part[k], whole[k]).real());
    const double mtf = std::sqrt(std::max(0.0, std::norm(whole[k]) - noise->across[k])) / step;
    std::vector<double> direction = at.direction(stated);
    const double up = at.mtf(tails.fit.farthest(direction)) - at.mtf(stated);
    for (double& value : direction) value = -value;
    const std::vector<double> weakest = tails.fit.farthest(direction);
    const double down = at.mtf(stated) - at.mtf(weakest);
    const double rounded = rounding * std::min(1.0, f / rounding_full_from_per_pitch);
    const double method = method_error(f) + (tails.fit.sharpened() ? sharpened_error : 0);
    const double half = std::hypot(t * std::sqrt(noise->along[k]) / step, method, rounded);
    found.mtf.push_back(mtf);
    found.low.push_back(std::max(0.0, mtf - std::hypot(half, std::max(0.0, down))));
    found.high.push_back((mtf + std::hypot(half, std::max(0.0, up))) / displaced(f, displacement_pitch2));
    found.low_known.push_back(!tails.fit.at_most_halo(weakest));
  }
  return found;
}

}  // namespace todbench
