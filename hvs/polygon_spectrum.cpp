// The closed-form Fourier transform of a polygon: at one frequency, and on a lattice without a trigonometric call in
// the inner loop.
#include "hvs/polygon_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// Below this |k . d| the quotient (E_v - E_v') / kd loses digits, and its series (next term kd^4 / 1920 < 1e-15) is
/// exact.
constexpr double series_limit = 1e-3;
/// Below this |k| times radius the sum over edges cancels; the rearranged sum does not.
constexpr double small_wave_limit = 0.05;

/// exp(-i angle) - 1 without cancellation.
std::complex<double> expm1_i(double angle) {
  const double half = std::sin(angle / 2);
  return {-2 * half * half, -std::sin(angle)};
}

/// sin(x)/x - 1 without cancellation.
double sinc_minus_one(double x) {
  const double y = x * x;
  return std::abs(x) < 0.3 ? y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 + y * (1.0 / 362880 - y / 39916800))))
                           : std::sin(x) / x - 1;
}

/// Vertices in the order that makes the signed area positive.
Polygon positively_ordered(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum >= 0 ? polygon : Polygon(polygon.rbegin(), polygon.rend());
}

double radius(const Polygon& polygon) {
  double largest = 0;
  for (const auto& v : polygon) largest = std::max(largest, std::hypot(v.x, v.y));
  return largest;
}

/// F = (i / k^2) sum_e kn_e exp(-i k.m_e) sinc(k.d_e / 2), with kn = kx dy - ky dx. The kn sum to zero over a closed
/// polygon, so exp() sinc() - 1 may stand in the sum, which keeps full relative accuracy as k -> 0.
std::complex<double> spectrum_at(const Polygon& polygon, double kx, double ky) {
  const double k_squared = kx * kx + ky * ky;
  if (k_squared == 0) return area(polygon);
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    const auto d = b - a;
    const double kn = kx * d.y - ky * d.x;
    const double angle = (kx * (a.x + b.x) + ky * (a.y + b.y)) / 2;
    const double s1 = sinc_minus_one((kx * d.x + ky * d.y) / 2);
    sum += kn * (expm1_i(angle) * (1 + s1) + s1);
  }
  return std::complex<double>(0, 1) / k_squared * sum;
}

/// exp(-2 pi i m x / period) for m = first..first + count - 1, real and imaginary parts apart.
struct PhaseTable {
  std::vector<double> re, im;
  PhaseTable(int first, int count, double x, double period) : re(static_cast<std::size_t>(count)), im(re.size()) {
    for (int i = 0; i < count; ++i) {
      // The fraction of a turn is reduced before the trigonometric functions see it: exact for whole and half turns.
      const double turns = static_cast<double>(first + i) * x / period;
      const double angle = -two_pi * (turns - std::nearbyint(turns));
      re[static_cast<std::size_t>(i)] = std::cos(angle);
      im[static_cast<std::size_t>(i)] = std::sin(angle);
    }
  }
};

/// One row of the lattice: wave numbers, and the sums over edges in split form.
struct Row {
  std::vector<double> kx, re, im, ratio;
  std::vector<std::vector<double>> e_re, e_im;
};

/// Adds edge v -> w to the row. `kn / kd` is zero where the quotient is unsafe; those points are computed singly
/// afterwards.
void add_edge(Row& row, std::size_t v, std::size_t w, cv::Point2d d, double ky) {
  const std::size_t n = row.kx.size();
  const double* kx = row.kx.data();
  double* ratio = row.ratio.data();
  for (std::size_t m = 0; m < n; ++m) {
    const double kd = kx[m] * d.x + ky * d.y;
    const double kn = kx[m] * d.y - ky * d.x;
    const double safe = std::abs(kd) < series_limit ? 1.0 : kd;
    ratio[m] = std::abs(kd) < series_limit ? 0.0 : kn / safe;
  }
  const double* vr = row.e_re[v].data();
  const double* vi = row.e_im[v].data();
  const double* wr = row.e_re[w].data();
  const double* wi = row.e_im[w].data();
  double* re = row.re.data();
  double* im = row.im.data();
  for (std::size_t m = 0; m < n; ++m) {
    re[m] += ratio[m] * (vr[m] - wr[m]);
    im[m] += ratio[m] * (vi[m] - wi[m]);
  }
}

}  // namespace

std::complex<double> polygon_spectrum(const Polygon& polygon, double u, double w) {
  return spectrum_at(positively_ordered(polygon), two_pi * u, two_pi * w);
}

cv::Mat_<std::complex<double>> polygon_spectrum(const Polygon& any_order, const FrequencyLattice& lattice) {
  const Polygon polygon = positively_ordered(any_order);
  const std::size_t vertices = polygon.size();
  const int columns = lattice.band + 1;
  const int rows = 2 * lattice.band + 1;
  const double period = lattice.period;
  const double reach = radius(polygon);
  std::vector<PhaseTable> ex, ey;
  for (const auto& vertex : polygon) {
    ex.emplace_back(0, columns, vertex.x, period);
    ey.emplace_back(-lattice.band, rows, vertex.y, period);
  }
  const auto n = static_cast<std::size_t>(columns);
  Row row{std::vector<double>(n),
          std::vector<double>(n),
          std::vector<double>(n),
          std::vector<double>(n),
          std::vector(vertices, std::vector<double>(n)),
          std::vector(vertices, std::vector<double>(n))};
  for (std::size_t m = 0; m < n; ++m) row.kx[m] = two_pi * static_cast<double>(m) / period;

  cv::Mat_<std::complex<double>> spectrum(rows, columns);
  for (int r = 0; r < rows; ++r) {
    const double ky = two_pi * (r - lattice.band) / period;
    for (std::size_t v = 0; v < vertices; ++v) {
      const double yr = ey[v].re[static_cast<std::size_t>(r)];
      const double yi = ey[v].im[static_cast<std::size_t>(r)];
      for (std::size_t m = 0; m < n; ++m) {
        row.e_re[v][m] = ex[v].re[m] * yr - ex[v].im[m] * yi;
        row.e_im[v][m] = ex[v].re[m] * yi + ex[v].im[m] * yr;
      }
    }
    std::fill(row.re.begin(), row.re.end(), 0.0);
    std::fill(row.im.begin(), row.im.end(), 0.0);
    for (std::size_t v = 0; v < vertices; ++v) {
      add_edge(row, v, (v + 1) % vertices, polygon[(v + 1) % vertices] - polygon[v], ky);
    }
    std::complex<double>* out = spectrum[r];
    for (std::size_t m = 0; m < n; ++m) {
      const double k_squared = row.kx[m] * row.kx[m] + ky * ky;
      out[m] = {row.re[m] / std::max(k_squared, 1e-300), row.im[m] / std::max(k_squared, 1e-300)};
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      const auto d = polygon[(v + 1) % vertices] - polygon[v];
      // Columns on which |kx dx + ky dy| is below the limit: all, none, or a short run round -ky dy / dx.
      std::size_t first = 0;
      std::size_t last = n;
      if (std::abs(d.x) * row.kx[n - 1] > series_limit) {
        const double step = two_pi / period;
        const double middle = -ky * d.y / d.x / step;
        const double half = series_limit / std::abs(d.x) / step + 1;
        first = static_cast<std::size_t>(std::clamp(std::floor(middle - half), 0.0, static_cast<double>(n)));
        last = static_cast<std::size_t>(std::clamp(std::ceil(middle + half) + 1, 0.0, static_cast<double>(n)));
      }
      for (std::size_t m = first; m < last; ++m) {
        if (std::abs(row.kx[m] * d.x + ky * d.y) < series_limit) out[m] = spectrum_at(polygon, row.kx[m], ky);
      }
    }
    for (std::size_t m = 0; m < n && std::hypot(row.kx[m], ky) * reach < small_wave_limit; ++m) {
      out[m] = spectrum_at(polygon, row.kx[m], ky);
    }
  }
  return spectrum;
}

}  // namespace todbench
