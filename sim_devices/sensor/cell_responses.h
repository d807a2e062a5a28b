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

inline constexpr int cell_reach = 6;  ///< a cell affects samples up to this distance beyond it, in samples
inline constexpr int response_side = 2 * cell_reach + 1;
inline constexpr int largest_degree = 24;

/// Values of the orthonormal Legendre polynomials on [-1/2, 1/2] at one position: p[a], and their integrals q[a] from
/// -1/2. For a >= 1 the integrals vanish at both limits of the range.
struct LegendreValues {
  std::array<double, largest_degree + 2> p{}, q{};
};
/// Returns the polynomials up to `degree`, which is at most largest_degree.
[[nodiscard]] LegendreValues legendre(double x, int degree);
/// Returns the pairs (a, b) with 1 <= a + b <= degree, sorted by a. All tables use this order.
[[nodiscard]] std::vector<std::pair<int, int>> legendre_pairs(int degree);

/// Transfer functions of image formation, with frequencies in cycles per sample. The optics are tabulated over the
/// radius and interpolated linearly.
class SampleTransfer {
 public:
  /// The upper limit of the band is the highest frequency that the planned effects pass, at most 16 cycles per pitch.
  SampleTransfer(const ChainScope& scope, const Accuracy& accuracy);
  [[nodiscard]] double band_per_sample() const { return band_ / per_pitch_; }
  /// Returns whether every effect in the chain is symmetric about both axes.
  [[nodiscard]] bool symmetric() const { return others_.empty(); }
  [[nodiscard]] double footprint(double f_per_sample, PitchAxis axis) const {
    return footprint_(f_per_sample * per_pitch_, axis);
  }
  /// Returns the squared radial frequency in cycles per sample along x.
  [[nodiscard]] double radius_squared(double u, double w) const { return u * u + w * w * per_aspect_squared_; }
  /// Returns the optics at a squared radial frequency; 0 beyond the band.
  [[nodiscard]] double optics(double rho_squared) const;
  /// Returns the product of all transfer functions except optics and footprint.
  [[nodiscard]] std::complex<double> rest(double u, double w) const;

 private:
  double per_pitch_, band_;
  double per_aspect_squared_;  ///< square of (pitch along x / pitch along y)
  FootprintMtf footprint_;
  std::vector<TransferFunction> others_;
  std::vector<double> optics_;
  int nodes_ = 0;  ///< nodes of the table of optics
};

/// Returns the responses of the samples around a cell to the polynomials of legendre_pairs() over that cell. The result
/// has one row for each polynomial, with response_side squared values, row by row.
[[nodiscard]] cv::Mat1f coefficient_responses(const SampleTransfer& transfer, int degree);
/// Returns the response to a unit cell, summed over all aliases, at the frequencies of a periodic grid of samples.
[[nodiscard]] cv::Mat2d unit_cell_response(const SampleTransfer& transfer, cv::Size size);

}  // namespace todbench
