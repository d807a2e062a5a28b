// SPDX-License-Identifier: GPL-3.0-or-later
// The closed-form Fourier transform of a polygon: at one frequency, and on a lattice without trigonometric calls in the
// inner loop.
#include "hvs/shape/polygon_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/multiversion.h"

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
/// polygon, so exp() sinc() - 1 can replace exp() sinc(), which keeps full relative accuracy as k -> 0.
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

/// factor * values, over `n` complex numbers.
TODBENCH_MULTIVERSION
void multiply(const double* re, const double* im, double fr, double fi, std::size_t n, double* __restrict out_re,
              double* __restrict out_im) {
  for (std::size_t m = 0; m < n; ++m) {
    out_re[m] = re[m] * fr - im[m] * fi;
    out_im[m] = re[m] * fi + im[m] * fr;
  }
}

/// Adds T_e = (kn / kd) (E_v - E_w) of the edge v -> w = v + d. At unsafe points the quotient is zero; these points are
/// computed singly afterwards.
TODBENCH_MULTIVERSION
void add_edge(const double* kx, double ky, cv::Point2d d, const double* vr, const double* vi, const double* wr,
              const double* wi, std::size_t n, double* __restrict re, double* __restrict im) {
  for (std::size_t m = 0; m < n; ++m) {
    const double kd = kx[m] * d.x + ky * d.y;
    const double kn = kx[m] * d.y - ky * d.x;
    const bool unsafe = std::abs(kd) < series_limit;
    // Both are selected before the division: otherwise a compiler may divide first, and by zero.
    const double ratio = (unsafe ? 0.0 : kn) / (unsafe ? 1.0 : kd);
    re[m] += ratio * (vr[m] - wr[m]);
    im[m] += ratio * (vi[m] - wi[m]);
  }
}

/// Divides by k^2.
TODBENCH_MULTIVERSION
void divide_by_square(const double* kx, double ky, std::size_t n, double* __restrict re, double* __restrict im) {
  for (std::size_t m = 0; m < n; ++m) {
    const double k_squared = kx[m] * kx[m] + ky * ky;
    const double safe = k_squared > 1e-300 ? k_squared : 1e-300;
    re[m] /= safe;
    im[m] /= safe;
  }
}

}  // namespace

std::complex<double> polygon_spectrum(const Polygon& polygon, double u, double w) {
  return spectrum_at(positively_ordered(polygon), two_pi * u, two_pi * w);
}

PolygonSpectrumRows::PhaseTable::PhaseTable(int first, int count, double x, double period)
    : re(static_cast<std::size_t>(count)), im(re.size()) {
  for (int i = 0; i < count; ++i) {
    // The fraction of a turn is reduced before the trigonometric calls: exact for whole and half turns.
    const double turns = static_cast<double>(first + i) * x / period;
    const double angle = -two_pi * (turns - std::nearbyint(turns));
    re[static_cast<std::size_t>(i)] = std::cos(angle);
    im[static_cast<std::size_t>(i)] = std::sin(angle);
  }
}

PolygonSpectrumRows::PolygonSpectrumRows(const Polygon& polygon, FrequencyLattice lattice)
    : polygon_(positively_ordered(polygon)), lattice_(lattice), reach_(radius(polygon_)) {
  const double period = lattice.period;
  for (const auto& vertex : polygon_) {
    ex_.emplace_back(0, lattice.band + 1, vertex.x, period);
    ey_.emplace_back(-lattice.band, 2 * lattice.band + 1, vertex.y, period);
  }
  const auto n = static_cast<std::size_t>(lattice.band) + 1;
  for (std::size_t m = 0; m < n; ++m) kx_.push_back(two_pi * static_cast<double>(m) / period);
  re_.resize(n);
  im_.resize(n);
  e_re_.assign(polygon_.size(), std::vector<double>(n));
  e_im_ = e_re_;
}

PolygonSpectrumRows::Row PolygonSpectrumRows::row(int r, std::size_t columns) {
  const double ky = two_pi * (r - lattice_.band) / lattice_.period;
  sum_edges(r, ky, columns);
  replace_unsafe(ky, columns);
  return {std::span(re_).first(columns), std::span(im_).first(columns)};
}

void PolygonSpectrumRows::sum_edges(int r, double ky, std::size_t n) {
  const std::size_t vertices = polygon_.size();
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto at = static_cast<std::size_t>(r);
    multiply(ex_[v].re.data(), ex_[v].im.data(), ey_[v].re[at], ey_[v].im[at], n, e_re_[v].data(), e_im_[v].data());
  }
  std::fill(re_.begin(), re_.end(), 0.0);
  std::fill(im_.begin(), im_.end(), 0.0);
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::size_t w = (v + 1) % vertices;
    add_edge(kx_.data(), ky, polygon_[w] - polygon_[v], e_re_[v].data(), e_im_[v].data(), e_re_[w].data(),
             e_im_[w].data(), n, re_.data(), im_.data());
  }
  divide_by_square(kx_.data(), ky, n, re_.data(), im_.data());
}

/// Recomputes the points at which the sum over edges loses digits.
void PolygonSpectrumRows::replace_unsafe(double ky, std::size_t n) {
  const auto replace = [&](std::size_t m) {
    const std::complex<double> value = spectrum_at(polygon_, kx_[m], ky);
    re_[m] = value.real();
    im_[m] = value.imag();
  };
  for (std::size_t v = 0; v < polygon_.size(); ++v) {
    const auto d = polygon_[(v + 1) % polygon_.size()] - polygon_[v];
    // Columns on which |kx dx + ky dy| is below the limit: all, none, or a short run around -ky dy / dx.
    std::size_t first = 0;
    std::size_t last = n;
    if (std::abs(d.x) * kx_.back() > series_limit) {
      const double step = two_pi / lattice_.period;
      const double middle = -ky * d.y / d.x / step;
      const double half = series_limit / std::abs(d.x) / step + 1;
      first = static_cast<std::size_t>(std::clamp(std::floor(middle - half), 0.0, static_cast<double>(n)));
      last = static_cast<std::size_t>(std::clamp(std::ceil(middle + half) + 1, 0.0, static_cast<double>(n)));
    }
    for (std::size_t m = first; m < last; ++m) {
      if (std::abs(kx_[m] * d.x + ky * d.y) < series_limit) replace(m);
    }
  }
  for (std::size_t m = 0; m < n && std::hypot(kx_[m], ky) * reach_ < small_wave_limit; ++m) replace(m);
}

cv::Mat_<std::complex<double>> polygon_spectrum(const Polygon& polygon, const FrequencyLattice& lattice) {
  PolygonSpectrumRows rows(polygon, lattice);
  cv::Mat_<std::complex<double>> spectrum(2 * lattice.band + 1, lattice.band + 1);
  for (int r = 0; r < spectrum.rows; ++r) {
    const auto [re, im] = rows.row(r, static_cast<std::size_t>(spectrum.cols));
    std::complex<double>* out = spectrum[r];
    for (std::size_t m = 0; m < re.size(); ++m) out[m] = {re[m], im[m]};
  }
  return spectrum;
}

}  // namespace todbench
