// The one routine of image formation: the closed-form spectrum of a polygon times a transfer function, on a grid.
// The sensor's image is a triangle times optics and detector, the observer's template the same triangle times its
// filter.
//
// The product is band-limited, so a sum over the lattice m / period holds the image exactly for every sampling phase.
// The only approximations are periodicity (signal that wraps round, decreasing as period^-3 for a diffraction-limited
// chain) and, where the filter has no limit of its own, the cut at the highest lattice frequency.
#pragma once

#include <complex>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "hvs/shape/polygon_spectrum.h"

namespace todbench {

/// Complex response at (u, w) in cycles per unit length; Hermitian: H(-u, -w) = conj H(u, w).
using TransferFunction = std::function<std::complex<double>(double u, double w)>;

/// A transfer function tabulated once on a lattice (half plane u >= 0; the rest follows by symmetry). Immutable,
/// thread-safe.
class FilterTable {
 public:
  FilterTable(FrequencyLattice lattice, const TransferFunction& transfer);
  [[nodiscard]] const FrequencyLattice& lattice() const { return lattice_; }
  /// Rows w = -band..band, columns u = 0..band.
  [[nodiscard]] const cv::Mat_<std::complex<double>>& values() const { return values_; }
  /// How many columns of a row there are up to the last that is not zero: optics cut off on a circle.
  [[nodiscard]] std::size_t extent(int row) const { return extents_[static_cast<std::size_t>(row)]; }
  /// Real, and equal at w and -w, to the last bit.
  [[nodiscard]] bool even() const { return even_; }
  /// Even, and equal at (u, w) and (w, u): pictures of shapes turned by quarters are turned pictures.
  [[nodiscard]] bool turns_alike() const { return turns_alike_; }

 private:
  FrequencyLattice lattice_;
  cv::Mat_<std::complex<double>> values_;
  std::vector<std::size_t> extents_;  ///< per row
  bool even_ = true, turns_alike_ = true;
};

/// The spectrum of one filtered polygon of contrast 1, ready to be sampled anywhere. Immutable, thread-safe; copies
/// share the spectrum. Of a shape that is its own mirror image in x or y, behind a filter that allows it, half is
/// computed and kept: the rows of -w are the conjugates of those of w.
class PolygonImage {
 public:
  /// `polygon` near the origin (it must fit into the period).
  PolygonImage(const Polygon& polygon, const FilterTable& filter);

  /// Values at (first.x + i step, first.y + j step), i < columns, j < rows.
  /// Requires that period / step is a whole number. Cost: one pass over the spectrum and a small sum; no 2-D FFT of the
  /// fine grid.
  [[nodiscard]] cv::Mat1d sample(cv::Point2d first, double step, cv::Size size) const;

  /// The whole period at `per_unit` points per unit length: all per_unit^2 sampling phases at once, by one inverse FFT.
  /// Point (j, i) is at (i, j) / per_unit, periodic (negative positions wrap). Rows are padded: not continuous.
  /// Requires per_unit * period > 2 band.
  [[nodiscard]] cv::Mat1d fine_image(int per_unit) const;
  /// The same for the points nearer to the origin than `reach` units, -reach <= x, y < reach; those beyond hold no
  /// image.
  [[nodiscard]] cv::Mat1d fine_image(int per_unit, int reach) const;

  /// This image turned by quarters, (x, y) -> (-y, x) each: that of the turned polygon where turns_alike().
  [[nodiscard]] PolygonImage turned(int quarters) const;
  /// Of the filter.
  [[nodiscard]] bool turns_alike() const { return turns_alike_; }

  [[nodiscard]] const FrequencyLattice& lattice() const { return lattice_; }

 private:
  [[nodiscard]] cv::Mat1d sample_upright(cv::Point2d first, double step, cv::Size size) const;
  [[nodiscard]] cv::Mat1d fine_rows(int points, int rows) const;

  FrequencyLattice lattice_;
  bool turns_alike_;
  bool half_ = false;                 ///< of the rows w = 0..band alone
  int turns_ = 0;                     ///< by quarters, of the image against its spectrum
  cv::Mat1d re_, im_;                 ///< parts of the spectrum, rows padded with zeros, so that sums over it vectorise
  std::vector<std::size_t> extents_;  ///< per row: columns up to the last that is not zero, padding included
};

}  // namespace todbench
