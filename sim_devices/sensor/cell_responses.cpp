// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/cell_responses.h"

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

constexpr int table_period = 32;    ///< samples; responses of coefficients have fallen by (26 / 6)^-4 at the wrap
constexpr int radial_nodes = 8192;  // at least

/// Fourier transform of the orthonormal polynomial of degree a: sqrt(2a+1) (-i)^a j_a(pi u).
std::complex<double> legendre_spectrum(int a, double u) {
  const double x = std::numbers::pi * std::abs(u);
  const double value = boost::math::sph_bessel(static_cast<unsigned>(a), x) * (u < 0 && a % 2 == 1 ? -1 : 1);
  static const std::complex<double> turns[4] = {{1, 0}, {0, -1}, {-1, 0}, {0, 1}};
  return std::sqrt(2 * a + 1.0) * value * turns[a % 4];
}

double cell_sinc(double x) {
  return x == 0 ? 1 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

}  // namespace

LegendreValues legendre(double x, int degree) {
  LegendreValues out;
  std::array<double, largest_degree + 2> plain{};
  plain[0] = 1;
  plain[1] = 2 * x;
  for (std::size_t n = 1; n <= static_cast<std::size_t>(degree); ++n) {
    const auto m = static_cast<double>(n);
    plain[n + 1] = ((2 * m + 1) * 2 * x * plain[n] - m * plain[n - 1]) / (m + 1);
  }
  out.p[0] = 1;
  for (std::size_t n = 1; n <= static_cast<std::size_t>(degree); ++n) {
    const double root = std::sqrt(2 * static_cast<double>(n) + 1);
    out.p[n] = root * plain[n];
    out.q[n] = (plain[n + 1] - plain[n - 1]) / (2 * root);
  }
  return out;
}

std::vector<std::pair<int, int>> legendre_pairs(int degree) {
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a <= degree; ++a) {
    for (int b = 0; a + b <= degree; ++b) {
      if (a + b > 0) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

SampleTransfer::SampleTransfer(const ChainScope& scope, const Accuracy& accuracy)
    : per_pitch_(scope.spec.samples_per_pitch()),
      band_(highest_frequency(scope.spec, scope.plan, accuracy)),
      per_aspect_squared_(std::pow(scope.spec.pitch_aspect(), -2)),
      footprint_(scope),
      others_(other_transfers(scope)) {
  const OpticsMtf optics(scope);
  // Ten nodes within the standard deviation of the transfer of the widest halo, a fifth of its reach.
  nodes_ = std::max(radial_nodes, static_cast<int>(std::ceil(13 * band_ * spread_of(scope).halo_reach)));
  for (int i = 0; i <= nodes_ + 1; ++i) optics_.push_back(optics(band_ * i / nodes_));
}

double SampleTransfer::optics(double rho_squared) const {
  const double place = std::sqrt(rho_squared) * per_pitch_ / band_ * nodes_;
  if (place > nodes_) return 0;
  const auto at = static_cast<std::size_t>(place);
  return optics_[at] + (place - static_cast<double>(at)) * (optics_[at + 1] - optics_[at]);
}

std::complex<double> SampleTransfer::rest(double u, double w) const {
  std::complex<double> value = 1;
  for (const auto& other : others_) value *= other(u * per_pitch_, w * per_pitch_);
  return value;
}

cv::Mat1f coefficient_responses(const SampleTransfer& transfer, int degree) {
  const auto pairs = legendre_pairs(degree);
  const int band = static_cast<int>(std::floor(transfer.band_per_sample() * table_period));
  const auto count = static_cast<std::size_t>(2 * band + 1);
  std::vector<std::vector<std::complex<double>>> spectra(static_cast<std::size_t>(degree) + 1);
  std::vector<double> along_x, along_y;
  for (int m = -band; m <= band; ++m) {
    along_x.push_back(transfer.footprint(static_cast<double>(m) / table_period, PitchAxis::x));
    along_y.push_back(transfer.footprint(static_cast<double>(m) / table_period, PitchAxis::y));
  }
  for (int a = 0; a <= degree; ++a) {
    for (int m = -band; m <= band; ++m)
      spectra[static_cast<std::size_t>(a)].push_back(legendre_spectrum(a, static_cast<double>(m) / table_period));
  }
  std::vector<std::complex<double>> chain(count * count);
  for (int n = -band; n <= band; ++n) {
    for (int m = -band; m <= band; ++m) {
      const double u = static_cast<double>(m) / table_period, w = static_cast<double>(n) / table_period;
      const auto i = static_cast<std::size_t>(m + band), j = static_cast<std::size_t>(n + band);
      const double value = transfer.optics(transfer.radius_squared(u, w)) * along_x[i] * along_y[j];
      chain[j * count + i] = value == 0 ? 0 : value * transfer.rest(u, w);
    }
  }
  const auto bin = [](int m) { return ((m % table_period) + table_period) % table_period; };
  cv::Mat1f out(static_cast<int>(pairs.size()), response_side * response_side);
  // Along x first, folded: all b of an a share the result.
  for (std::size_t first = 0; first < pairs.size();) {
    const int a = pairs[first].first;
    cv::Mat_<std::complex<double>> along(static_cast<int>(count), table_period, std::complex<double>(0, 0));
    for (std::size_t j = 0; j < count; ++j) {
      std::complex<double>* row = along[static_cast<int>(j)];
      for (std::size_t i = 0; i < count; ++i)
        row[bin(static_cast<int>(i) - band)] += chain[j * count + i] * spectra[static_cast<std::size_t>(a)][i];
    }
    for (; first < pairs.size() && pairs[first].first == a; ++first) {
      cv::Mat2d folded(table_period, table_period, cv::Vec2d(0, 0));
      const auto& own = spectra[static_cast<std::size_t>(pairs[first].second)];
      for (std::size_t j = 0; j < count; ++j) {
        const std::complex<double>* row = along[static_cast<int>(j)];
        cv::Vec2d* sum = folded[bin(static_cast<int>(j) - band)];
        for (int k = 0; k < table_period; ++k) {
          const std::complex<double> value = row[k] * own[j];
          sum[k] += cv::Vec2d(value.real(), value.imag());
        }
      }
      cv::Mat2d image;
      cv::dft(folded, image, cv::DFT_INVERSE);
      for (int j = -cell_reach; j <= cell_reach; ++j) {
        for (int i = -cell_reach; i <= cell_reach; ++i) {
          out(static_cast<int>(first), (j + cell_reach) * response_side + i + cell_reach) =
              static_cast<float>(image(bin(j), bin(i))[0] / (table_period * table_period));
        }
      }
    }
  }
  return out;
}

cv::Mat2d unit_cell_response(const SampleTransfer& transfer, cv::Size size) {
  const double band = transfer.band_per_sample();
  const int aliases = static_cast<int>(std::ceil(band));
  struct Axis {
    std::vector<double> f, factor;  ///< [bin][alias]
  };
  const auto axis = [&](int n, PitchAxis which) {
    Axis out;
    for (int k = 0; k < n; ++k) {
      const double base = static_cast<double>(k <= n / 2 ? k : k - n) / n;
      for (int m = -aliases; m <= aliases; ++m) {
        const double f = base + m;
        out.f.push_back(f);
        out.factor.push_back(std::abs(f) > band ? 0 : transfer.footprint(f, which) * cell_sinc(f));
      }
    }
    return out;
  };
  const Axis x = axis(size.width, PitchAxis::x), y = axis(size.height, PitchAxis::y);
  const auto per = static_cast<std::size_t>(2 * aliases + 1);
  cv::Mat2d out(size);
  // If no effect depends on direction, a quarter of the plane is sufficient.
  const int columns = size.width / 2 + 1, rows = transfer.symmetric() ? size.height / 2 + 1 : size.height;
  for (int k = 0; k < rows; ++k) {
    for (int l = 0; l < columns; ++l) {
      std::complex<double> sum = 0;
      double plain = 0;
      for (std::size_t n = 0; n < per; ++n) {
        const auto at_y = static_cast<std::size_t>(k) * per + n;
        if (y.factor[at_y] == 0) continue;
        const double w = y.f[at_y];
        for (std::size_t m = 0; m < per; ++m) {
          const auto at_x = static_cast<std::size_t>(l) * per + m;
          const double factor = x.factor[at_x] * y.factor[at_y];
          if (factor == 0) continue;
          const double value = factor * transfer.optics(transfer.radius_squared(x.f[at_x], w));
          if (transfer.symmetric())
            plain += value;
          else
            sum += value * transfer.rest(x.f[at_x], w);
        }
      }
      sum += plain;
      out(k, l) = {sum.real(), sum.imag()};
    }
  }
  for (int k = 0; k < size.height; ++k) {
    for (int l = 0; l < size.width; ++l) {
      if (k < rows && l < columns) continue;
      if (transfer.symmetric()) {
        out(k, l) = out(std::min(k, size.height - k), std::min(l, size.width - l));
      } else {
        const cv::Vec2d mirrored = out((size.height - k) % size.height, size.width - l);
        out(k, l) = {mirrored[0], -mirrored[1]};
      }
    }
  }
  return out;
}

}  // namespace todbench
