// What the samples of a sensor see of light within one cell of their grid.
#pragma once

#include <array>
#include <complex>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "sim_devices/sensor/transfer_functions.h"

namespace todbench {

inline constexpr int cell_reach = 6;  ///< samples beyond a cell to which its coefficients count
inline constexpr int response_side = 2 * cell_reach + 1;
inline constexpr int largest_degree = 24;

/// Orthonormal Legendre polynomials on [-1/2, 1/2] at one place: p[a], and q[a], their integrals from -1/2, which for
/// a >= 1 vanish at both ends.
struct LegendreValues {
  std::array<double, largest_degree + 2> p{}, q{};
};
/// Up to `degree`, at most largest_degree.
[[nodiscard]] LegendreValues legendre(double x, int degree);
/// Pairs (a, b) with 1 <= a + b <= degree, a first, in the order of all tables.
[[nodiscard]] std::vector<std::pair<int, int>> legendre_pairs(int degree);

/// Image formation with frequencies in cycles per sample; optics from a table by radius, linear between its nodes.
class SampleTransfer {
 public:
  /// Up to the band that the rows of the plan's effects ask for, at most 16 cycles per pitch.
  SampleTransfer(const ChainScope& scope, const Accuracy& accuracy);
  [[nodiscard]] double band_per_sample() const { return band_ / per_pitch_; }
  /// Whether nothing in the chain has a direction.
  [[nodiscard]] bool symmetric() const { return others_.empty(); }
  [[nodiscard]] double footprint(double f_per_sample) const { return footprint_(f_per_sample * per_pitch_); }
  /// At a squared radial frequency; 0 beyond the band.
  [[nodiscard]] double optics(double rho_squared) const;
  /// What is neither optics nor footprint.
  [[nodiscard]] std::complex<double> rest(double u, double w) const;

 private:
  double per_pitch_, band_;
  FootprintMtf footprint_;
  std::vector<TransferFunction> others_;
  std::vector<double> optics_;
};

/// Responses to the polynomials of legendre_pairs() over a cell at the samples round it, a row each: response_side
/// squared values, row by row.
[[nodiscard]] cv::Mat1f coefficient_responses(const SampleTransfer& transfer, int degree);
/// The response to a unit cell, all aliases summed, at the frequencies of a periodic grid of samples.
[[nodiscard]] cv::Mat2d unit_cell_response(const SampleTransfer& transfer, cv::Size size);

}  // namespace todbench
