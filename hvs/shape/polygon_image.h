// SPDX-License-Identifier: GPL-3.0-or-later
// Image formation: the closed-form spectrum of a polygon times a transfer function, sampled on a grid. The sensor's
// image is a triangle times optics and detector; the observer's template is the same triangle times its filter.
//
// The product is band-limited, so a sum over the lattice m / period represents the image exactly at every sampling
// phase. There are only two approximations. First, the image is periodic: signal beyond one border appears at the
// opposite border. For a diffraction-limited chain, this error decreases as period^-3. Second, a filter that is not
// band-limited is cut off at the highest lattice frequency.
#pragma once

#include <complex>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "hvs/shape/polygon_spectrum.h"

namespace todbench {

/// Complex response at (u, w) in cycles per unit length; Hermitian: H(-u, -w) = conj H(u, w).
using TransferFunction = std::function<std::complex<double>(double u, double w)>;

/// A transfer function tabulated on a lattice, in the half plane u >= 0; the other half follows by symmetry. Immutable,
/// thread-safe.
class FilterTable {
 public:
  FilterTable(FrequencyLattice lattice, const TransferFunction& transfer);
  [[nodiscard]] const FrequencyLattice& lattice() const { return lattice_; }
  /// Returns the table: rows w = -band..band, columns u = 0..band.
  [[nodiscard]] const cv::Mat_<std::complex<double>>& values() const { return values_; }
  /// Returns the number of columns of a row up to the last value that is not zero. This number differs between rows,
  /// because the cut-off of optics is a circle.
  [[nodiscard]] std::size_t extent(int row) const { return extents_[static_cast<std::size_t>(row)]; }
  /// Returns whether all values are real and bit-identical at w and -w.
  [[nodiscard]] bool even() const { return even_; }
  /// Returns whether the table is even and equal at (u, w) and (w, u). Then the image of a shape rotated by 90 degrees
  /// is the rotated image.
  [[nodiscard]] bool turns_alike() const { return turns_alike_; }

 private:
  FrequencyLattice lattice_;
  cv::Mat_<std::complex<double>> values_;
  std::vector<std::size_t> extents_;  ///< result of extent() for each row
  bool even_ = true, turns_alike_ = true;
};

/// Spectrum of one filtered polygon of contrast 1. It can be sampled at any positions. Immutable, thread-safe; copies
/// share the spectrum. If shape and filter are both symmetric in x or y, only half of the spectrum is computed and
/// stored, because the rows of -w are the conjugates of the rows of w.
class PolygonImage {
 public:
  /// Computes the spectrum. Precondition: `polygon` is near the origin and fits into the period.
  PolygonImage(const Polygon& polygon, const FilterTable& filter);

  /// Returns the values at (first.x + i step, first.y + j step), i < columns, j < rows. Precondition: period / step is
  /// a whole number. The computation takes one pass over the spectrum and a small sum, without a 2-D FFT of the fine
  /// grid.
  [[nodiscard]] cv::Mat1d sample(cv::Point2d first, double step, cv::Size size) const;

  /// Returns the whole period at `per_unit` points per unit length. One inverse FFT computes all per_unit^2 sampling
  /// phases. Point (j, i) is at (i, j) / per_unit, periodic (negative positions wrap). Rows are padded, so the matrix
  /// is not continuous. Precondition: per_unit * period > 2 band.
  [[nodiscard]] cv::Mat1d fine_image(int per_unit) const;
  /// Returns the same picture with only the points -reach <= x, y < reach (in unit lengths) defined.
  [[nodiscard]] cv::Mat1d fine_image(int per_unit, int reach) const;

  /// Returns this image rotated by quarter turns; each maps (x, y) to (-y, x). If turns_alike(), this is the image of
  /// the rotated polygon.
  [[nodiscard]] PolygonImage turned(int quarters) const;
  /// Returns FilterTable::turns_alike() of the filter.
  [[nodiscard]] bool turns_alike() const { return turns_alike_; }

  [[nodiscard]] const FrequencyLattice& lattice() const { return lattice_; }

 private:
  [[nodiscard]] cv::Mat1d sample_upright(cv::Point2d first, double step, cv::Size size) const;
  [[nodiscard]] cv::Mat1d fine_rows(int points, int rows) const;

  FrequencyLattice lattice_;
  bool turns_alike_;
  bool half_ = false;  ///< true: only the rows w = 0..band are stored
  int turns_ = 0;      ///< quarter turns of the image relative to its spectrum
  cv::Mat1d re_, im_;  ///< parts of the spectrum; rows are padded with zeros so that sums over them vectorise
  /// Number of columns of each row up to the last value that is not zero, padding included.
  std::vector<std::size_t> extents_;
};

}  // namespace todbench
