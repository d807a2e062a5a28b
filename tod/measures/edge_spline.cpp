// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/edge_spline.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

/// Cell of a value between two knots, and its place in it.
struct Place {
  std::size_t cell = 0;
  double u = 0;  ///< 0 ... 1
};

Place place_of(const SplineGrid& grid, double t) {
  const double at = std::clamp((t - grid.start) / grid.step, 0.0, static_cast<double>(grid.cells));
  const double cell = std::min(std::floor(at), static_cast<double>(grid.cells - 1));
  return {static_cast<std::size_t>(cell), at - cell};
}

/// The four cubic B-splines over a cell (de Boor 1978).
std::array<double, 4> values_at(double u) {
  const double v = 1 - u;
  return {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6};
}

std::array<double, 4> slopes_at(double u) {
  const double v = 1 - u;
  return {-v * v / 2, (3 * u * u - 4 * u) / 2, -(3 * v * v - 4 * v) / 2, u * u / 2};
}

double combined(const Spline& spline, std::size_t cell, const std::array<double, 4>& factors) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += factors[i] * spline.coefficients[cell + i];
  return sum;
}

constexpr double smoothing = 1e-5;  // of the mean diagonal

}  // namespace

double Spline::value(double t) const {
  const Place place = place_of(grid, t);
  return combined(*this, place.cell, values_at(place.u));
}

double Spline::slope(double t) const {
  const Place place = place_of(grid, t);
  return combined(*this, place.cell, slopes_at(place.u)) / grid.step;
}

SplineSums::SplineSums(const SplineGrid& grid)
    : grid_(grid), band_(grid.coefficients(), std::array<double, 4>{}), right_(grid.coefficients(), 0.0) {}

void SplineSums::add(double t, double value) {
  if (!(t >= grid_.start && t <= grid_.end())) return;
  const Place place = place_of(grid_, t);
  const auto factors = values_at(place.u);
  for (std::size_t i = 0; i < 4; ++i) {
    right_[place.cell + i] += factors[i] * value;
    for (std::size_t j = i; j < 4; ++j) band_[place.cell + i][j - i] += factors[i] * factors[j];
  }
  samples_ += 1;
}

SplineSums& SplineSums::operator+=(const SplineSums& other) {
  for (std::size_t i = 0; i < band_.size(); ++i) {
    for (std::size_t j = 0; j < 4; ++j) band_[i][j] += other.band_[i][j];
    right_[i] += other.right_[i];
  }
  samples_ += other.samples_;
  return *this;
}

SplineSums& SplineSums::operator-=(const SplineSums& other) {
  for (std::size_t i = 0; i < band_.size(); ++i) {
    for (std::size_t j = 0; j < 4; ++j) band_[i][j] -= other.band_[i][j];
    right_[i] -= other.right_[i];
  }
  samples_ -= other.samples_;
  return *this;
}

std::optional<Spline> SplineSums::solve() const {
  const std::size_t count = band_.size();
  if (samples_ < static_cast<double>(count)) return std::nullopt;
  auto band = band_;
  double diagonal = 0;
  for (const auto& row : band) diagonal += row[0] / static_cast<double>(count);
  constexpr std::array third{-1.0, 3.0, -3.0, 1.0};
  for (std::size_t k = 0; k + 3 < count; ++k) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i; j < 4; ++j) band[k + i][j - i] += smoothing * diagonal * third[i] * third[j];
    }
  }
  // Cholesky of a band: band[i][j] becomes L(i + j, i).
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < 4 && i + j < count; ++j) {
      double sum = band[i][j];
      for (std::size_t k = 1; k + j < 4 && k <= i; ++k) sum -= band[i - k][k] * band[i - k][k + j];
      if (j == 0) {
        if (!(sum > 0)) return std::nullopt;
        band[i][0] = std::sqrt(sum);
      } else {
        band[i][j] = sum / band[i][0];
      }
    }
  }
  Spline spline{grid_, right_};
  std::vector<double>& c = spline.coefficients;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 1; k < 4 && k <= i; ++k) c[i] -= band[i - k][k] * c[i - k];
    c[i] /= band[i][0];
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = 1; k < 4 && i + k < count; ++k) c[i] -= band[i][k] * c[i + k];
    c[i] /= band[i][0];
  }
  return spline;
}

}  // namespace todbench
