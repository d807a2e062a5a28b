// SPDX-License-Identifier: GPL-3.0-or-later
// Responses of a sensor's samples to light within one cell of the sampling grid.
#pragma once

#include <array>
#include <complex>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "sim_devices/sensor/transfer_functions.h"

namespace todbench {

inline constexpr int cell_reach = 6;  ///< distance from a cell up to which the cell affects samples, in samples
inline constexpr int response_side = 2 * cell_reach + 1;  ///< side of the square of affected samples, in samples
inline constexpr int largest_degree = 24;                 ///< highest supported degree of the Legendre polynomials

/// Orthonormal Legendre polynomials on [-1/2, 1/2] at a position x, by degree a: p[a] is the value, q[a] the integral
/// from -1/2 to x. For a >= 1 the integral is 0 at both ends of the range. q[0] is not computed and is 0.
struct LegendreValues {
  std::array<double, largest_degree + 2> p{}, q{};
};
/// Returns the values at `x`, -1/2 to 1/2, for degrees 0 to `degree`. `degree` is at most largest_degree.
[[nodiscard]] LegendreValues legendre(double x, int degree);
/// Returns the degrees (a, b) along x and y with 1 <= a + b <= degree, sorted by a, then by b, as in all tables.
[[nodiscard]] std::vector<std::pair<int, int>> legendre_pairs(int degree);

/// Transfer functions of image formation, with frequencies in cycles per sample. The transfer function of the optics is
/// tabulated over the radial frequency and interpolated linearly.
class SampleTransfer {
 public:
  /// Creates the transfer functions. Their band ends at highest_frequency(), at most 16 cycles per pitch.
  SampleTransfer(const ChainScope& scope, const Accuracy& accuracy);
  [[nodiscard]] double band_per_sample() const { return band_ / per_pitch_; }
  /// Returns whether every effect in the chain is symmetric about both axes.
  [[nodiscard]] bool symmetric() const { return others_.empty(); }
  [[nodiscard]] double footprint(double f_per_sample, PitchAxis axis) const {
    return footprint_(f_per_sample * per_pitch_, axis);
  }
  /// Returns the square of the radial frequency, in (cycles per sample along x)^2; u, w in cycles per sample.
  [[nodiscard]] double radius_squared(double u, double w) const { return u * u + w * w * per_aspect_squared_; }
  /// Returns the transfer function of the optics at a radius_squared(); 0 beyond the band.
  [[nodiscard]] double optics(double rho_squared) const;
  /// Returns the product of all transfer functions except optics and footprint; u, w in cycles per sample.
  [[nodiscard]] std::complex<double> rest(double u, double w) const;

 private:
  double per_pitch_, band_;
  double per_aspect_squared_;  ///< square of (pitch along x / pitch along y)
  FootprintMtf footprint_;
  std::vector<TransferFunction> others_;
  std::vector<double> optics_;
  int nodes_ = 0;  ///< number of equal intervals of optics_ over the band
};

/// Returns the responses of the samples around a cell to the polynomials of legendre_pairs() over that cell. The matrix
/// has one row for each polynomial: response_side x response_side samples, line by line.
[[nodiscard]] cv::Mat1f coefficient_responses(const SampleTransfer& transfer, int degree);
/// Returns the spectrum of the response to a cell of level 1 on a periodic grid of `size` samples, aliases summed.
[[nodiscard]] cv::Mat2d unit_cell_response(const SampleTransfer& transfer, cv::Size size);

}  // namespace todbench
