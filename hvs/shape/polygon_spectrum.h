// SPDX-License-Identifier: GPL-3.0-or-later
// The closed-form Fourier transform of a polygon.
#pragma once

#include <complex>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "hvs/shape/polygon.h"

namespace todbench {

/// The frequencies m / period, |m| <= band, in both directions.
struct FrequencyLattice {
  int period = 32;  ///< period in unit lengths (pitches or samples), >= 1
  int band = 203;   ///< highest m kept; the highest frequency is band / period
  bool operator==(const FrequencyLattice&) const = default;
};

/// Returns the Fourier transform of the polygon's indicator at frequency (u, w), in cycles per unit length: the
/// integral of exp(-2 pi i (u x + w y)) over its area. The transform is a sum over edges with sinc factors. The
/// relative error is about 1e-15 times the number of turns of the phase, u x + w y, also at the origin and for wave
/// vectors perpendicular to an edge.
[[nodiscard]] std::complex<double> polygon_spectrum(const Polygon& polygon, double u, double w);

/// Returns the Fourier transform on a lattice: rows w = -band..band, columns u = 0..band. The other half plane follows
/// by symmetry. Phase factors are separable and tabulated per row and column. The difference from the function for a
/// single frequency is below 1e-13 of the area.
[[nodiscard]] cv::Mat_<std::complex<double>> polygon_spectrum(const Polygon& polygon, const FrequencyLattice& lattice);

/// Computes the Fourier transform on a lattice row by row, with separate real and imaginary parts. Use it to filter a
/// row while the row is in the cache. One thread at a time.
class PolygonSpectrumRows {
 public:
  PolygonSpectrumRows(const Polygon& polygon, FrequencyLattice lattice);
  struct Row {
    std::span<const double> re, im;  ///< columns u = 0, 1, ...; valid until the next call
  };
  /// Returns the first `columns` of row `r`: w = r - band, r = 0 .. 2 band.
  [[nodiscard]] Row row(int r, std::size_t columns);

 private:
  /// exp(-2 pi i m x / period), with separate real and imaginary parts.
  struct PhaseTable {
    std::vector<double> re, im;
    PhaseTable(int first, int count, double x, double period);
  };
  void sum_edges(int r, double ky, std::size_t n);
  void replace_unsafe(double ky, std::size_t n);

  Polygon polygon_;
  FrequencyLattice lattice_;
  double reach_;
  std::vector<PhaseTable> ex_, ey_;               ///< phase tables of each vertex along x and y
  std::vector<double> kx_, re_, im_;              ///< frequencies and sums of the present row
  std::vector<std::vector<double>> e_re_, e_im_;  ///< exp(-i k.v) of each vertex v in the present row
};

}  // namespace todbench
