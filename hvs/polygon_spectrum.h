// The closed-form Fourier transform of a polygon.
#pragma once

#include <complex>
#include <opencv2/core.hpp>
#include <vector>

#include "hvs/polygon.h"

namespace todbench {

/// The frequencies m / period, |m| <= band, in both directions.
struct FrequencyLattice {
  int period = 32;  ///< in unit lengths (pitches or samples), >= 1
  int band = 203;   ///< highest m kept; the highest frequency is band / period
  bool operator==(const FrequencyLattice&) const = default;
};

/// Fourier transform of the polygon's indicator at frequency (u, w), in cycles per unit length: the integral of
/// exp(-2 pi i (u x + w y)) over its area. Sum over edges with sinc factors; relative accuracy near 1e-15 times the
/// number of turns, also for wave vectors perpendicular to an edge and at the origin.
[[nodiscard]] std::complex<double> polygon_spectrum(const Polygon& polygon, double u, double w);

/// The same on a lattice, half plane u >= 0 (the rest follows by symmetry): rows w = -band..band, columns u = 0..band.
/// Phase factors are separable and tabulated per row and column; agrees with the single-frequency form to 1e-13 of the
/// area.
[[nodiscard]] cv::Mat_<std::complex<double>> polygon_spectrum(const Polygon& polygon, const FrequencyLattice& lattice);

}  // namespace todbench
