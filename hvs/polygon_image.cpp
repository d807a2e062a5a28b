#include "hvs/polygon_image.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

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

/// out[j][i] = Re sum_b sum_k folded[b][k] exp(2 pi i (b j + k i) / n): a small inverse transform of which only a
/// corner is wanted.
cv::Mat1d corner_of_inverse(const cv::Mat_<Complex>& folded, cv::Size size) {
  const int n = folded.rows;
  std::vector<Complex> roots(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) roots[static_cast<std::size_t>(i)] = turn(static_cast<double>(i) / n);
  cv::Mat1d out(size);
  std::vector<double> re(static_cast<std::size_t>(n)), im(re.size());
  for (int j = 0; j < size.height; ++j) {
    std::fill(re.begin(), re.end(), 0.0);
    std::fill(im.begin(), im.end(), 0.0);
    for (int b = 0; b < n; ++b) {
      const Complex root = roots[static_cast<std::size_t>(static_cast<long>(b) * j % n)];
      const Complex* row = folded[b];
      for (int k = 0; k < n; ++k) {
        re[static_cast<std::size_t>(k)] += row[k].real() * root.real() - row[k].imag() * root.imag();
        im[static_cast<std::size_t>(k)] += row[k].real() * root.imag() + row[k].imag() * root.real();
      }
    }
    for (int i = 0; i < size.width; ++i) {
      double sum = 0;
      for (int k = 0; k < n; ++k) {
        const Complex root = roots[static_cast<std::size_t>(static_cast<long>(k) * i % n)];
        sum += re[static_cast<std::size_t>(k)] * root.real() - im[static_cast<std::size_t>(k)] * root.imag();
      }
      out(j, i) = sum;
    }
  }
  return out;
}

struct FftwFree {
  void operator()(void* memory) const { fftw_free(memory); }
};

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
    : lattice_(filter.lattice()), spectrum_(polygon_spectrum(polygon, filter.lattice())) {
  for (int row = 0; row < spectrum_.rows; ++row) {
    Complex* values = spectrum_[row];
    const Complex* gains = filter.values()[row];
    for (int column = 0; column < spectrum_.cols; ++column) {
      const Complex v = values[column];
      const Complex g = gains[column];
      values[column] = {v.real() * g.real() - v.imag() * g.imag(), v.real() * g.imag() + v.imag() * g.real()};
    }
  }
}

cv::Mat1d PolygonImage::sample(cv::Point2d first, double step, cv::Size size) const {
  const int n = static_cast<int>(std::lround(lattice_.period / step));
  CV_Assert(std::abs(n * step - lattice_.period) < 1e-9 * lattice_.period);
  const int band = lattice_.band;
  const double period = lattice_.period;
  const auto columns = static_cast<std::size_t>(band) + 1;

  // Rows: shift to first.y, then fold frequencies that the sampling cannot tell apart.
  std::vector<std::vector<double>> re(static_cast<std::size_t>(n), std::vector<double>(columns, 0.0));
  auto im = re;
  for (int row = 0; row < spectrum_.rows; ++row) {
    const Complex ramp = turn((row - band) * first.y / period);
    const Complex* values = spectrum_[row];
    const auto bin = static_cast<std::size_t>(wrapped(row - band, n));
    double* fold_re = re[bin].data();
    double* fold_im = im[bin].data();
    for (std::size_t m = 0; m < columns; ++m) {
      fold_re[m] += values[m].real() * ramp.real() - values[m].imag() * ramp.imag();
      fold_im[m] += values[m].real() * ramp.imag() + values[m].imag() * ramp.real();
    }
  }
  // Columns likewise. Frequencies u > 0 count twice, for their mirror images; the real part is taken at the end.
  cv::Mat_<Complex> folded(n, n, Complex(0, 0));
  for (std::size_t m = 0; m < columns; ++m) {
    const Complex ramp = turn(static_cast<double>(m) * first.x / period) * (m == 0 ? 1.0 : 2.0);
    const int bin = static_cast<int>(m) % n;
    for (int row = 0; row < n; ++row) {
      const auto r = static_cast<std::size_t>(row);
      folded(row, bin) +=
          Complex(re[r][m] * ramp.real() - im[r][m] * ramp.imag(), re[r][m] * ramp.imag() + im[r][m] * ramp.real());
    }
  }
  cv::Mat1d out = corner_of_inverse(folded, size);
  out /= period * period;
  return out;
}

cv::Mat1d PolygonImage::fine_image(int per_unit) const {
  const int n = per_unit * lattice_.period;
  const int band = lattice_.band;
  CV_Assert(n > 2 * band);
  const std::size_t half = static_cast<std::size_t>(n) / 2 + 1;
  const std::unique_ptr<fftw_complex[], FftwFree> data(fftw_alloc_complex(static_cast<std::size_t>(n) * half));
  std::fill_n(&data[0][0], 2 * static_cast<std::size_t>(n) * half, 0.0);
  for (int row = 0; row < spectrum_.rows; ++row) {
    const auto target = static_cast<std::size_t>(wrapped(row - band, n)) * half;
    for (int m = 0; m <= band; ++m) {
      data[target + static_cast<std::size_t>(m)][0] = spectrum_(row, m).real();
      data[target + static_cast<std::size_t>(m)][1] = spectrum_(row, m).imag();
    }
  }
  inverse_in_place(data.get(), n);
  cv::Mat1d out(n, n);
  const double scale = 1.0 / (static_cast<double>(lattice_.period) * lattice_.period);
  for (int row = 0; row < n; ++row) {
    const double* values = reinterpret_cast<const double*>(data.get() + static_cast<std::size_t>(row) * half);
    double* target = out[row];
    for (int column = 0; column < n; ++column) target[column] = values[column] * scale;
  }
  return out;
}

}  // namespace todbench
