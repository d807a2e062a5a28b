#include "hvs/polygon_image.h"

#include <fftw3.h>

#include <algorithm>
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

/// A complex matrix, real and imaginary parts apart: the form in which inner loops vectorise.
struct SplitMatrix {
  std::size_t columns;
  std::vector<double> re, im;
  SplitMatrix(int rows, std::size_t n) : columns(n), re(static_cast<std::size_t>(rows) * n), im(re.size()) {}
};

/// sum += values * factor, over `n` complex numbers.
TODBENCH_MULTIVERSION
void add_product(const double* re, const double* im, Complex factor, std::size_t n, double* sum_re, double* sum_im) {
  const double fr = factor.real();
  const double fi = factor.imag();
  for (std::size_t k = 0; k < n; ++k) {
    sum_re[k] += re[k] * fr - im[k] * fi;
    sum_im[k] += re[k] * fi + im[k] * fr;
  }
}

/// values * factors, number by number.
TODBENCH_MULTIVERSION
void product(const double* re, const double* im, const Complex* factors, std::size_t n, double* out_re,
             double* out_im) {
  for (std::size_t k = 0; k < n; ++k) {
    out_re[k] = re[k] * factors[k].real() - im[k] * factors[k].imag();
    out_im[k] = re[k] * factors[k].imag() + im[k] * factors[k].real();
  }
}

/// sum += values * factors, number by number.
TODBENCH_MULTIVERSION
void add_products(const double* re, const double* im, const Complex* factors, std::size_t n, double* sum_re,
                  double* sum_im) {
  for (std::size_t k = 0; k < n; ++k) {
    sum_re[k] += re[k] * factors[k].real() - im[k] * factors[k].imag();
    sum_im[k] += re[k] * factors[k].imag() + im[k] * factors[k].real();
  }
}

/// sum += Re(factor * roots), over `n` points.
TODBENCH_MULTIVERSION
void add_real_part(double fr, double fi, const double* roots_re, const double* roots_im, std::size_t n, double* sum) {
  for (std::size_t i = 0; i < n; ++i) sum[i] += fr * roots_re[i] - fi * roots_im[i];
}

/// out[j][i] = Re sum_b sum_k folded[b][k] exp(2 pi i (b j + k i) / n): a small inverse transform of which only a
/// corner is wanted. Every sum runs over b and k in increasing order, whatever the instruction set.
cv::Mat1d corner_of_inverse(const SplitMatrix& folded, cv::Size size) {
  const std::size_t n = folded.columns;
  const auto width = static_cast<std::size_t>(size.width);
  std::vector<Complex> roots(n);
  for (std::size_t i = 0; i < n; ++i) roots[i] = turn(static_cast<double>(i) / static_cast<double>(n));
  SplitMatrix along(static_cast<int>(n), width);  // row k: exp(2 pi i k i / n)
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0, bin = 0; i < width; ++i, bin = (bin + k) % n) {
      along.re[k * width + i] = roots[bin].real();
      along.im[k * width + i] = roots[bin].imag();
    }
  }
  cv::Mat1d out(size, 0.0);
  std::vector<double> re(n), im(n);
  for (int j = 0; j < size.height; ++j) {
    std::fill(re.begin(), re.end(), 0.0);
    std::fill(im.begin(), im.end(), 0.0);
    for (std::size_t b = 0; b < n; ++b) {
      const Complex root = roots[b * static_cast<std::size_t>(j) % n];
      add_product(&folded.re[b * n], &folded.im[b * n], root, n, re.data(), im.data());
    }
    for (std::size_t k = 0; k < n; ++k)
      add_real_part(re[k], im[k], &along.re[k * width], &along.im[k * width], width, out[j]);
  }
  return out;
}

/// In-place complex-to-real inverse transform of n x n points. FFTW_ESTIMATE, so that results repeat bit for bit.
void inverse_in_place(fftw_complex* data, int n) {
  static std::mutex planner;  // FFTW's planner is not thread-safe; executing a plan is
  fftw_plan plan = nullptr;
  {
    const std::scoped_lock lock(planner);
    plan = fftw_plan_dft_c2r_2d(n, n, data, reinterpret_cast<double*>(data), FFTW_ESTIMATE);
  }
  fftw_execute(plan);
  const std::scoped_lock lock(planner);
  fftw_destroy_plan(plan);
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
  }
}

PolygonImage::PolygonImage(const Polygon& polygon, const FilterTable& filter)
    : lattice_(filter.lattice()), re_(filter.values().size()), im_(filter.values().size()) {
  PolygonSpectrumRows spectrum(polygon, lattice_);
  for (int row = 0; row < re_.rows; ++row) {
    const auto [re, im] = spectrum.row(row);
    product(re.data(), im.data(), filter.values()[row], re.size(), re_[row], im_[row]);
  }
}

cv::Mat1d PolygonImage::sample(cv::Point2d first, double step, cv::Size size) const {
  const int n = static_cast<int>(std::lround(lattice_.period / step));
  CV_Assert(std::abs(n * step - lattice_.period) < 1e-9 * lattice_.period);
  const int band = lattice_.band;
  const double period = lattice_.period;
  const auto columns = static_cast<std::size_t>(band) + 1;

  // Rows: shift to first.y, then fold frequencies that the sampling cannot tell apart.
  SplitMatrix rows(n, columns);
  for (int row = 0; row < re_.rows; ++row) {
    const Complex ramp = turn((row - band) * first.y / period);
    const std::size_t at = static_cast<std::size_t>(wrapped(row - band, n)) * columns;
    add_product(re_[row], im_[row], ramp, columns, &rows.re[at], &rows.im[at]);
  }
  // Columns likewise. Frequencies u > 0 count twice, for their mirror images; the real part is taken at the end.
  std::vector<Complex> ramps(columns);
  for (std::size_t m = 0; m < columns; ++m)
    ramps[m] = turn(static_cast<double>(m) * first.x / period) * (m == 0 ? 1.0 : 2.0);
  const auto bins = static_cast<std::size_t>(n);
  SplitMatrix folded(n, bins);
  for (std::size_t row = 0; row < bins; ++row) {
    const double* re = &rows.re[row * columns];
    const double* im = &rows.im[row * columns];
    for (std::size_t begin = 0; begin < columns; begin += bins)
      add_products(re + begin, im + begin, &ramps[begin], std::min(bins, columns - begin), &folded.re[row * bins],
                   &folded.im[row * bins]);
  }
  cv::Mat1d out = corner_of_inverse(folded, size);
  out /= period * period;
  return out;
}

cv::Mat1d PolygonImage::fine_image(int per_unit) const {
  const int n = per_unit * lattice_.period;
  const int band = lattice_.band;
  CV_Assert(n > 2 * band);
  // Transformed in place: rows of n / 2 + 1 complex numbers become rows of n real ones with padding behind.
  const int half = n / 2 + 1;
  cv::Mat1d data(n, 2 * half, 0.0);
  for (int row = 0; row < re_.rows; ++row) {
    const double* re = re_[row];
    const double* im = im_[row];
    double* target = data[wrapped(row - band, n)];
    for (int m = 0; m <= band; ++m) {
      target[2 * m] = re[m];
      target[2 * m + 1] = im[m];
    }
  }
  inverse_in_place(reinterpret_cast<fftw_complex*>(data.ptr<double>()), n);
  cv::Mat1d out = data.colRange(0, n);
  const double scale = 1.0 / (static_cast<double>(lattice_.period) * lattice_.period);
  for (int row = 0; row < n; ++row) {
    double* values = out[row];
    for (int column = 0; column < n; ++column) values[column] *= scale;
  }
  return out;
}

}  // namespace todbench
