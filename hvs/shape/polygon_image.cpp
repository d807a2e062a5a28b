#include "hvs/shape/polygon_image.h"

#include <fftw3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>
#include <vector>

#include "acquisition/core/multiversion.h"

namespace todbench {
namespace {

using Complex = std::complex<double>;

/// exp(+2 pi i turns), exact for multiples of half a turn.
Complex turn(double turns) {
  const double angle = 2 * std::numbers::pi * (turns - std::nearbyint(turns));
  return {std::cos(angle), std::sin(angle)};
}

/// Remainder in [0, n).
int wrapped(int index, int n) {
  return ((index % n) + n) % n;
}

/// Columns summed together, in registers.
constexpr std::size_t lanes = 16;

std::size_t padded(std::size_t columns) {
  return (columns + lanes - 1) / lanes * lanes;
}

/// A complex matrix, real and imaginary parts apart, rows padded with zeros to whole lanes: the form in which sums over
/// rows vectorise.
struct SplitMatrix {
  std::size_t stride;
  std::vector<double> re, im;
  SplitMatrix(std::size_t rows, std::size_t columns) : stride(padded(columns)), re(rows * stride), im(re.size()) {}
};

/// Eight numbers added or multiplied element by element (GCC and Clang): an explicit vector, because the compiler's own
/// choice pairs real with imaginary parts and shuffles more than it computes.
using Eight = double __attribute__((vector_size(64)));
using EightInMemory = double __attribute__((vector_size(64), aligned(8), may_alias));
static_assert(lanes == 2 * 8);

/// `lanes` columns of sum_b factor_b row_b, b = 0..rows-1 in this order, real and imaginary parts.
TODBENCH_MULTIVERSION
void sum_rows(const double* re, const double* im, std::size_t stride, const Complex* factors, std::size_t rows,
              double* sum_re, double* sum_im) {
  Eight r0 = {}, r1 = {}, i0 = {}, i1 = {};
  for (std::size_t b = 0; b < rows; ++b) {
    const double fr = factors[b].real();
    const double fi = factors[b].imag();
    const auto* row_re = reinterpret_cast<const EightInMemory*>(re + b * stride);
    const auto* row_im = reinterpret_cast<const EightInMemory*>(im + b * stride);
    r0 += row_re[0] * fr - row_im[0] * fi;
    r1 += row_re[1] * fr - row_im[1] * fi;
    i0 += row_re[0] * fi + row_im[0] * fr;
    i1 += row_re[1] * fi + row_im[1] * fr;
  }
  auto* out_re = reinterpret_cast<EightInMemory*>(sum_re);
  auto* out_im = reinterpret_cast<EightInMemory*>(sum_im);
  out_re[0] = r0;
  out_re[1] = r1;
  out_im[0] = i0;
  out_im[1] = i1;
}

/// Rows read together: as many streams as the memory system follows.
constexpr std::size_t rows_at_once = 4;

/// Adds factor_b row_b, b = 0..rows_at_once-1 in this order, to `columns` (whole lanes) sums.
TODBENCH_MULTIVERSION
void add_four_rows(const double* re, const double* im, std::size_t stride, const Complex* factors, std::size_t columns,
                   double* sum_re, double* sum_im) {
  for (std::size_t k = 0; k < columns; k += 8) {
    auto* out_re = reinterpret_cast<EightInMemory*>(sum_re + k);
    auto* out_im = reinterpret_cast<EightInMemory*>(sum_im + k);
    Eight r = *out_re, i = *out_im;
    for (std::size_t b = 0; b < rows_at_once; ++b) {
      const double fr = factors[b].real();
      const double fi = factors[b].imag();
      const auto row_re = *reinterpret_cast<const EightInMemory*>(re + b * stride + k);
      const auto row_im = *reinterpret_cast<const EightInMemory*>(im + b * stride + k);
      r += row_re * fr - row_im * fi;
      i += row_re * fi + row_im * fr;
    }
    *out_re = r;
    *out_im = i;
  }
}

TODBENCH_MULTIVERSION
void add_row(const double* re, const double* im, Complex factor, std::size_t columns, double* sum_re, double* sum_im) {
  const double fr = factor.real();
  const double fi = factor.imag();
  for (std::size_t k = 0; k < columns; k += 8) {
    auto* out_re = reinterpret_cast<EightInMemory*>(sum_re + k);
    auto* out_im = reinterpret_cast<EightInMemory*>(sum_im + k);
    const auto row_re = *reinterpret_cast<const EightInMemory*>(re + k);
    const auto row_im = *reinterpret_cast<const EightInMemory*>(im + k);
    *out_re += row_re * fr - row_im * fi;
    *out_im += row_re * fi + row_im * fr;
  }
}

/// The same, real part only.
TODBENCH_MULTIVERSION
void sum_rows_real(const double* re, const double* im, std::size_t stride, const double* factors_re,
                   const double* factors_im, std::size_t rows, double* sum) {
  Eight r0 = {}, r1 = {};
  for (std::size_t b = 0; b < rows; ++b) {
    const auto* row_re = reinterpret_cast<const EightInMemory*>(re + b * stride);
    const auto* row_im = reinterpret_cast<const EightInMemory*>(im + b * stride);
    r0 += factors_re[b] * row_re[0] - factors_im[b] * row_im[0];
    r1 += factors_re[b] * row_re[1] - factors_im[b] * row_im[1];
  }
  auto* out = reinterpret_cast<EightInMemory*>(sum);
  out[0] = r0;
  out[1] = r1;
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

/// out[j][i] = Re sum_b sum_k folded[b][k] exp(2 pi i (b j + k i) / n): a small inverse transform of which only a
/// corner is wanted. Every sum runs over b and k in increasing order, whatever the instruction set.
cv::Mat1d corner_of_inverse(const SplitMatrix& folded, int points, cv::Size size) {
  const auto n = static_cast<std::size_t>(points);
  const auto width = static_cast<std::size_t>(size.width);
  std::vector<Complex> roots(n);
  for (std::size_t i = 0; i < n; ++i) roots[i] = turn(static_cast<double>(i) / points);
  SplitMatrix along(n, width);  // row k: exp(2 pi i k i / n)
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0, bin = 0; i < width; ++i, bin = (bin + k) % n) {
      along.re[k * along.stride + i] = roots[bin].real();
      along.im[k * along.stride + i] = roots[bin].imag();
    }
  }
  cv::Mat1d out(size);
  std::vector<Complex> factors(n);
  std::vector<double> re(folded.stride), im(folded.stride), row(along.stride);
  for (int j = 0; j < size.height; ++j) {
    for (std::size_t b = 0; b < n; ++b) factors[b] = roots[b * static_cast<std::size_t>(j) % n];
    for (std::size_t k = 0; k < folded.stride; k += lanes)
      sum_rows(&folded.re[k], &folded.im[k], folded.stride, factors.data(), n, &re[k], &im[k]);
    for (std::size_t i = 0; i < along.stride; i += lanes)
      sum_rows_real(&along.re[i], &along.im[i], along.stride, re.data(), im.data(), n, &row[i]);
    std::copy_n(row.begin(), width, out[j]);
  }
  return out;
}

/// Complex-to-real inverse transform of n x n points in place, of which only the first `columns` columns of each row
/// are not zero. Only the first `rows` and the last `rows` rows of the result are computed. FFTW_ESTIMATE, so that
/// results repeat bit for bit.
void inverse_in_place(fftw_complex* data, int n, int columns, int rows) {
  static std::mutex planner;  // FFTW's planner is not thread-safe; executing a plan is
  const int half = n / 2 + 1;
  const auto along_rows = [&](int first, int count) {
    fftw_complex* begin = data + static_cast<std::ptrdiff_t>(first) * half;
    return fftw_plan_many_dft_c2r(1, &n, count, begin, nullptr, 1, half, reinterpret_cast<double*>(begin), nullptr, 1,
                                  2 * half, FFTW_ESTIMATE);
  };
  std::array<fftw_plan, 3> plans{};
  {
    const std::scoped_lock lock(planner);
    plans[0] = fftw_plan_many_dft(1, &n, columns, data, nullptr, half, 1, data, nullptr, half, 1, FFTW_BACKWARD,
                                  FFTW_ESTIMATE);
    if (2 * rows >= n) {
      plans[1] = along_rows(0, n);
    } else {
      plans[1] = along_rows(0, rows);
      plans[2] = along_rows(n - rows, rows);
    }
  }
  for (fftw_plan plan : plans) {
    if (plan != nullptr) fftw_execute(plan);
  }
  const std::scoped_lock lock(planner);
  for (fftw_plan plan : plans) {
    if (plan != nullptr) fftw_destroy_plan(plan);
  }
}

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
}

PolygonImage::PolygonImage(const Polygon& polygon, const FilterTable& filter) : lattice_(filter.lattice()) {
  const cv::Size size(static_cast<int>(padded(static_cast<std::size_t>(lattice_.band) + 1)), 2 * lattice_.band + 1);
  re_ = cv::Mat1d(size, 0.0);
  im_ = cv::Mat1d(size, 0.0);
  PolygonSpectrumRows spectrum(polygon, lattice_);
  for (int row = 0; row < re_.rows; ++row) {
    const auto [re, im] = spectrum.row(row, filter.extent(row));
    extents_.push_back(padded(re.size()));
    product(re.data(), im.data(), filter.values()[row], re.size(), re_[row], im_[row]);
  }
}

cv::Mat1d PolygonImage::sample(cv::Point2d first, double step, cv::Size size) const {
  const int n = static_cast<int>(std::lround(lattice_.period / step));
  CV_Assert(std::abs(n * step - lattice_.period) < 1e-9 * lattice_.period);
  const int band = lattice_.band;
  const double period = lattice_.period;
  const auto columns = static_cast<std::size_t>(band) + 1;

  // Rows: shift to first.y, then fold frequencies that the sampling cannot tell apart: every n-th row into one.
  const auto bins = static_cast<std::size_t>(n);
  SplitMatrix rows(bins, columns);
  std::vector<Complex> ramps;
  for (int top = 0; top < std::min(n, re_.rows); ++top) {
    ramps.clear();
    for (int row = top; row < re_.rows; row += n) ramps.push_back(turn((row - band) * first.y / period));
    const std::size_t at = static_cast<std::size_t>(wrapped(top - band, n)) * rows.stride;
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
  // Columns likewise. Frequencies u > 0 count twice, for their mirror images; the real part is taken at the end.
  ramps.clear();
  for (std::size_t m = 0; m < columns; ++m)
    ramps.push_back(turn(static_cast<double>(m) * first.x / period) * (m == 0 ? 1.0 : 2.0));
  SplitMatrix folded(bins, bins);
  for (std::size_t row = 0; row < bins; ++row) {
    const double* re = &rows.re[row * rows.stride];
    const double* im = &rows.im[row * rows.stride];
    const std::size_t at = row * folded.stride;
    for (std::size_t m = 0; m < columns; m += bins)
      add_products(re + m, im + m, &ramps[m], std::min(bins, columns - m), &folded.re[at], &folded.im[at]);
  }
  cv::Mat1d out = corner_of_inverse(folded, n, size);
  out /= period * period;
  return out;
}

cv::Mat1d PolygonImage::fine_image(int per_unit) const {
  return fine_image(per_unit, lattice_.period);
}

cv::Mat1d PolygonImage::fine_image(int per_unit, int reach) const {
  CV_Assert(reach > 0);
  const int n = per_unit * lattice_.period;
  const int band = lattice_.band;
  CV_Assert(n > 2 * band);
  // Transformed in place: rows of n / 2 + 1 complex numbers become rows of n real ones with padding behind.
  const int half = n / 2 + 1;
  cv::Mat1d data(n, 2 * half);
  data.colRange(2 * (band + 1), 2 * half) = 0;
  data(cv::Range(band + 1, n - band), cv::Range(0, 2 * (band + 1))) = 0;
  for (int row = 0; row < re_.rows; ++row) {
    const double* re = re_[row];
    const double* im = im_[row];
    double* target = data[wrapped(row - band, n)];
    for (int m = 0; m <= band; ++m) {
      target[2 * m] = re[m];
      target[2 * m + 1] = im[m];
    }
  }
  const int rows = std::min(n, reach * per_unit);
  inverse_in_place(reinterpret_cast<fftw_complex*>(data.ptr<double>()), n, band + 1, rows);
  cv::Mat1d out = data.colRange(0, n);
  const double scale = 1.0 / (static_cast<double>(lattice_.period) * lattice_.period);
  for (int row = 0; row < n; ++row) {
    if (row >= rows && row < n - rows) continue;
    double* values = out[row];
    for (int column = 0; column < n; ++column) values[column] *= scale;
  }
  return out;
}

}  // namespace todbench
