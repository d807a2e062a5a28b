// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/polygon_image.h"

#include <fftw3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <type_traits>
#include <vector>

#include "acquisition/base/multiversion.h"
#include "hvs/shape/corner_transform.h"

namespace todbench {
namespace {

using Complex = std::complex<double>;

/// Remainder in [0, n).
int wrapped(int index, int n) {
  return ((index % n) + n) % n;
}

/// Rows read together: as many streams as the memory system can follow.
constexpr std::size_t rows_at_once = 4;

/// Adds factor_b row_b, b = 0..`rows`-1 in this order, to `columns` (whole lanes) sums.
template <std::size_t rows>
[[gnu::always_inline]] inline void add_rows(const double* re, const double* im, std::size_t stride,
                                            const Complex* factors, std::size_t columns, double* sum_re,
                                            double* sum_im) {
  constexpr std::size_t pairs = 4;
  for (std::size_t k = 0; k < columns; k += 2 * pairs) {
    auto* out_re = reinterpret_cast<TwoInMemory*>(sum_re + k);
    auto* out_im = reinterpret_cast<TwoInMemory*>(sum_im + k);
    Two r[pairs], i[pairs];
    for (std::size_t l = 0; l < pairs; ++l) r[l] = out_re[l], i[l] = out_im[l];
    for (std::size_t b = 0; b < rows; ++b) {
      const double fr = factors[b].real();
      const double fi = factors[b].imag();
      const auto* row_re = reinterpret_cast<const TwoInMemory*>(re + b * stride + k);
      const auto* row_im = reinterpret_cast<const TwoInMemory*>(im + b * stride + k);
      for (std::size_t l = 0; l < pairs; ++l) {
        r[l] += row_re[l] * fr - row_im[l] * fi;
        i[l] += row_re[l] * fi + row_im[l] * fr;
      }
    }
    for (std::size_t l = 0; l < pairs; ++l) out_re[l] = r[l], out_im[l] = i[l];
  }
}

TODBENCH_MULTIVERSION
void add_four_rows(const double* re, const double* im, std::size_t stride, const Complex* factors, std::size_t columns,
                   double* sum_re, double* sum_im) {
  add_rows<rows_at_once>(re, im, stride, factors, columns, sum_re, sum_im);
}

TODBENCH_MULTIVERSION
void add_row(const double* re, const double* im, Complex factor, std::size_t columns, double* sum_re, double* sum_im) {
  add_rows<1>(re, im, 0, &factor, columns, sum_re, sum_im);
}

/// values * factors, number by number.
TODBENCH_MULTIVERSION
void product(const double* re, const double* im, const Complex* factors, std::size_t n, double* __restrict out_re,
             double* __restrict out_im) {
  for (std::size_t k = 0; k < n; ++k) {
    out_re[k] = re[k] * factors[k].real() - im[k] * factors[k].imag();
    out_im[k] = re[k] * factors[k].imag() + im[k] * factors[k].real();
  }
}

/// sum += values * factors, number by number.
TODBENCH_MULTIVERSION
void add_products(const double* re, const double* im, const Complex* factors, std::size_t n, double* __restrict sum_re,
                  double* __restrict sum_im) {
  for (std::size_t k = 0; k < n; ++k) {
    sum_re[k] += re[k] * factors[k].real() - im[k] * factors[k].imag();
    sum_im[k] += re[k] * factors[k].imag() + im[k] * factors[k].real();
  }
}

/// Adds to every row b the conjugate of the original row -b.
void add_conjugates(SplitMatrix& rows) {
  const std::size_t n = rows.re.size() / rows.stride;
  for (std::size_t b = 0; 2 * b <= n; ++b) {
    const std::size_t at = b * rows.stride, mirror = (n - b) % n * rows.stride;
    for (std::size_t m = 0; m < rows.stride; ++m) {
      rows.re[mirror + m] = rows.re[at + m] += rows.re[mirror + m];
      rows.im[at + m] -= rows.im[mirror + m];
      rows.im[mirror + m] = -rows.im[at + m];
    }
  }
}

/// turn(m * turns) for m = first..first+count-1, as products of two table values: one rounding more than single calls.
std::vector<Complex> turns_of(int first, int count, double turns) {
  constexpr int together = 16;
  std::array<Complex, together> fine;
  for (int i = 0; i < together; ++i) fine[static_cast<std::size_t>(i)] = turn(i * turns);
  std::vector<Complex> out;
  out.reserve(static_cast<std::size_t>(count + together));
  for (int m = first; m < first + count; m += together) {
    const Complex coarse = turn(m * turns);
    for (const Complex& own : fine)
      out.emplace_back(coarse.real() * own.real() - coarse.imag() * own.imag(),
                       coarse.real() * own.imag() + coarse.imag() * own.real());
  }
  return out;
}

struct DestroyPlan {
  void operator()(fftw_plan plan) const { fftw_destroy_plan(plan); }
};
using OwnedPlan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, DestroyPlan>;

/// Inverse transforms of n contiguous points: complex in place, and to real numbers. FFTW_ESTIMATE, so that results
/// repeat bit for bit.
struct InversePlans {
  OwnedPlan complex, real;
};

/// Planned once for each length, kept until the program ends; addresses must be multiples of 16 bytes.
const InversePlans& inverse_plans(int n) {
  static std::mutex planner;  // FFTW's planner is not thread-safe; executing a plan is
  static std::map<int, InversePlans> plans;
  const std::scoped_lock lock(planner);
  InversePlans& own = plans[n];
  if (own.real == nullptr) {
    cv::Mat1d in(1, 2 * n), out(1, n);
    auto* numbers = reinterpret_cast<fftw_complex*>(in[0]);
    own.complex.reset(fftw_plan_dft_1d(n, numbers, numbers, FFTW_BACKWARD, FFTW_ESTIMATE));
    own.real.reset(fftw_plan_dft_c2r_1d(n, numbers, out[0], FFTW_ESTIMATE));
  }
  return own;
}

/// Applies (x, y) -> (-y, x) `quarters` times.
cv::Point2d turned_point(cv::Point2d p, int quarters) {
  for (int k = 0; k < wrapped(quarters, 4); ++k) p = {-p.y, p.x};
  return p;
}

/// Whether x -> -x maps the polygon onto itself, to the last bit.
bool is_mirrored(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t i = 0;
    while (i < n && polygon[i] == cv::Point2d(-polygon[(k + n - i) % n].x, polygon[(k + n - i) % n].y)) ++i;
    if (i == n) return true;
  }
  return false;
}

/// Spectra of this many columns are reordered together: a cache line.
constexpr int columns_at_once = 8;

}  // namespace

FilterTable::FilterTable(FrequencyLattice lattice, const TransferFunction& transfer)
    : lattice_(lattice), values_(2 * lattice.band + 1, lattice.band + 1) {
  CV_Assert(lattice.period >= 1 && lattice.band >= 0);
  const double period = lattice.period;
  for (int row = 0; row < values_.rows; ++row) {
    for (int column = 0; column < values_.cols; ++column) {
      values_(row, column) = transfer(column / period, (row - lattice.band) / period);
    }
    int extent = values_.cols;
    while (extent > 0 && values_(row, extent - 1) == Complex(0, 0)) --extent;
    extents_.push_back(static_cast<std::size_t>(extent));
  }
  for (int w = 0; w <= lattice.band && even_; ++w) {
    for (int u = 0; u <= lattice.band && even_; ++u) {
      const Complex value = values_(lattice.band + w, u);
      even_ = value.imag() == 0 && value == values_(lattice.band - w, u);
      turns_alike_ = turns_alike_ && value == values_(lattice.band + u, w);
    }
  }
  turns_alike_ = turns_alike_ && even_;
}

PolygonImage::PolygonImage(const Polygon& polygon, const FilterTable& filter)
    : lattice_(filter.lattice()), turns_alike_(filter.turns_alike()) {
  Polygon shape = polygon;
  half_ = filter.even() && is_mirrored(shape);
  if (!half_ && turns_alike_) {
    for (auto& vertex : shape) vertex = turned_point(vertex, -1);
    half_ = is_mirrored(shape);
    turns_ = half_ ? 1 : 0;
    if (!half_) shape = polygon;
  }
  const int top = half_ ? lattice_.band : 0;
  const cv::Size size(static_cast<int>(whole_lanes(static_cast<std::size_t>(lattice_.band) + 1)),
                      2 * lattice_.band + 1 - top);
  re_ = cv::Mat1d(size, 0.0);
  im_ = cv::Mat1d(size, 0.0);
  PolygonSpectrumRows spectrum(shape, lattice_);
  for (int row = 0; row < re_.rows; ++row) {
    const auto [re, im] = spectrum.row(top + row, filter.extent(top + row));
    extents_.push_back(whole_lanes(re.size()));
    product(re.data(), im.data(), filter.values()[top + row], re.size(), re_[row], im_[row]);
  }
}

PolygonImage PolygonImage::turned(int quarters) const {
  PolygonImage out = *this;
  out.turns_ = wrapped(turns_ + quarters, 4);
  return out;
}

cv::Mat1d PolygonImage::sample(cv::Point2d first, double step, cv::Size size) const {
  if (turns_ == 0) return sample_upright(first, step, size);
  // The two corners of the window, rotated back; between them lie the samples of the spectrum's own image.
  const cv::Point2d a = turned_point(first, -turns_);
  const cv::Point2d b = turned_point(first + step * cv::Point2d(size.width - 1, size.height - 1), -turns_);
  const bool odd = turns_ % 2 == 1;
  const cv::Mat1d upright =
      sample_upright({std::min(a.x, b.x), std::min(a.y, b.y)}, step, odd ? cv::Size(size.height, size.width) : size);
  constexpr std::array<int, 3> codes{cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_COUNTERCLOCKWISE};
  cv::Mat1d out;
  cv::rotate(upright, out, codes[static_cast<std::size_t>(turns_ - 1)]);
  return out;
}

cv::Mat1d PolygonImage::sample_upright(cv::Point2d first, double step, cv::Size size) const {
  const int n = static_cast<int>(std::lround(lattice_.period / step));
  CV_Assert(std::abs(n * step - lattice_.period) < 1e-9 * lattice_.period);
  const int band = lattice_.band;
  const double period = lattice_.period;
  const auto columns = static_cast<std::size_t>(band) + 1;

  // Rows: shift to first.y, then add frequencies that the sampling cannot distinguish: every n-th row into one.
  const auto bins = static_cast<std::size_t>(n);
  const int lowest = half_ ? 0 : -band;
  SplitMatrix rows(bins, columns);
  std::vector<Complex> ramps, turns = turns_of(lowest, re_.rows, first.y / period);
  if (half_) turns[0] = 0.5;
  for (int top = 0; top < std::min(n, re_.rows); ++top) {
    ramps.clear();
    for (int row = top; row < re_.rows; row += n) ramps.push_back(turns[static_cast<std::size_t>(row)]);
    const std::size_t at = static_cast<std::size_t>(wrapped(top + lowest, n)) * rows.stride;
    const std::size_t stride = bins * re_.step1();
    const auto extent = [&](std::size_t b) { return extents_[static_cast<std::size_t>(top) + b * bins]; };
    std::size_t b = 0;
    for (; b + rows_at_once <= ramps.size(); b += rows_at_once) {
      std::size_t widest = 0;
      for (std::size_t k = b; k < b + rows_at_once; ++k) widest = std::max(widest, extent(k));
      add_four_rows(re_[top] + b * stride, im_[top] + b * stride, stride, &ramps[b], widest, &rows.re[at],
                    &rows.im[at]);
    }
    for (; b < ramps.size(); ++b)
      add_row(re_[top] + b * stride, im_[top] + b * stride, ramps[b], extent(b), &rows.re[at], &rows.im[at]);
  }
  if (half_) add_conjugates(rows);
  // The same for columns. Frequencies u > 0 count twice, for their mirror images; the real part is taken at the end.
  turns = turns_of(0, band + 1, first.x / period);
  turns[0] = 0.5;
  SplitMatrix folded(bins, bins);
  for (std::size_t row = 0; row < bins; ++row) {
    const double* re = &rows.re[row * rows.stride];
    const double* im = &rows.im[row * rows.stride];
    const std::size_t at = row * folded.stride;
    for (std::size_t m = 0; m < columns; m += bins)
      add_products(re + m, im + m, &turns[m], std::min(bins, columns - m), &folded.re[at], &folded.im[at]);
  }
  cv::Mat1d out = corner_of_inverse(folded, n, size);
  out *= 2 / (period * period);
  return out;
}

cv::Mat1d PolygonImage::fine_image(int per_unit) const {
  return fine_image(per_unit, lattice_.period);
}

cv::Mat1d PolygonImage::fine_image(int per_unit, int reach) const {
  CV_Assert(reach > 0);
  const int n = per_unit * lattice_.period;
  CV_Assert(n > 2 * lattice_.band);
  const int points = std::min(n, 2 * reach * per_unit);
  if (turns_ == 0) return fine_rows(n, (points + 1) / 2);
  const cv::Mat1d upright = fine_rows(n, points / 2 + 1);
  cv::Mat1d out(n, n);
  for (int y = -points / 2; y < (points + 1) / 2; ++y) {
    double* row = out[wrapped(y, n)];
    for (int x = -points / 2; x < (points + 1) / 2; ++x) {
      const cv::Point p = turns_ == 1 ? cv::Point(y, -x) : turns_ == 2 ? cv::Point(-x, -y) : cv::Point(-y, x);
      row[wrapped(x, n)] = upright(wrapped(p.y, n), wrapped(p.x, n));
    }
  }
  return out;
}

/// The first `rows` and the last `rows` of n, by transforms along the columns and then along those rows. If only half
/// of a spectrum is kept, its columns are real.
cv::Mat1d PolygonImage::fine_rows(int n, int rows) const {
  const int band = lattice_.band;
  const int half = n / 2 + 1;
  const InversePlans& plans = inverse_plans(n);
  const double scale = 1.0 / (static_cast<double>(lattice_.period) * lattice_.period);
  const auto wanted = [&](int row) { return row < rows || row >= n - rows; };
  cv::Mat1d data(n, 2 * half);  // rows of `half` complex numbers become rows of n real ones with padding
  cv::Mat1d spectra(columns_at_once, 2 * n), real(columns_at_once, n + n % 2);
  for (int first = 0; first <= band; first += columns_at_once) {
    const int count = std::min(columns_at_once, band + 1 - first);
    spectra = 0;
    for (int row = 0; row < re_.rows; ++row) {
      const int at = 2 * (half_ ? row : wrapped(row - band, n));
      for (int k = 0; k < count; ++k) {
        spectra(k, at) = scale * re_(row, first + k);
        spectra(k, at + 1) = scale * im_(row, first + k);
      }
    }
    for (int k = 0; k < count; ++k) {
      auto* column = reinterpret_cast<fftw_complex*>(spectra[k]);
      if (half_) {
        fftw_execute_dft_c2r(plans.real.get(), column, real[k]);
      } else {
        fftw_execute_dft(plans.complex.get(), column, column);
      }
    }
    for (int row = 0; row < n; ++row) {
      if (!wanted(row)) continue;
      double* target = data[row] + 2 * first;
      for (int k = 0; k < count; ++k) {
        target[2 * k] = half_ ? real(k, row) : spectra(k, 2 * row);
        target[2 * k + 1] = half_ ? 0.0 : spectra(k, 2 * row + 1);
      }
    }
  }
  cv::Mat1d line(1, 2 * half);
  for (int row = 0; row < n; ++row) {
    if (!wanted(row)) continue;
    std::copy_n(data[row], 2 * (band + 1), line[0]);
    std::fill(line[0] + 2 * (band + 1), line[0] + 2 * half, 0.0);
    fftw_execute_dft_c2r(plans.real.get(), reinterpret_cast<fftw_complex*>(line[0]), data[row]);
  }
  return data.colRange(0, n);
}

}  // namespace todbench
