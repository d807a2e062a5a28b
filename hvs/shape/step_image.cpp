// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/step_image.h"

#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace todbench {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;

/// exp(-2 pi i m x / period), m = first ... first + count - 1.
std::vector<std::complex<double>> phases_of(int first, int count, double x, double period) {
  std::vector<std::complex<double>> out;
  for (int i = 0; i < count; ++i) {
    const double turns = (first + i) * x / period;
    const double angle = -full_turn * (turns - std::nearbyint(turns));
    out.emplace_back(std::cos(angle), std::sin(angle));
  }
  return out;
}

struct Corner {
  std::vector<std::complex<double>> along_x, along_y, row;
};

/// Edges with shared corners, whose phases are computed once.
class EdgeSpectrum {
 public:
  EdgeSpectrum(std::span<const StepEdge> edges, FrequencyLattice lattice) : edges_(edges), lattice_(lattice) {
    std::map<std::pair<double, double>, std::size_t> known;
    const auto corner = [&](cv::Point2d p) {
      const auto [at, is_new] = known.try_emplace({p.x, p.y}, corners_.size());
      if (is_new) {
        corners_.push_back({phases_of(0, lattice.band + 1, p.x, lattice.period),
                            phases_of(-lattice.band, 2 * lattice.band + 1, p.y, lattice.period),
                            {}});
      }
      return at->second;
    };
    for (const auto& edge : edges) ends_.emplace_back(corner(edge.a), corner(edge.b));
  }

  /// F = (1 / k^2) sum of -step kn (E_a - E_b) / kd, kn = kx dy - ky dx, kd = k.d; equals the spectrum of a polygon if
  /// every edge has the step -1 outwards. Returns the first `columns` values of the row w = r - band.
  std::vector<std::complex<double>> row(int r, std::size_t columns) {
    const double ky = full_turn * (r - lattice_.band) / lattice_.period;
    for (Corner& corner : corners_) {
      corner.row.resize(columns);
      for (std::size_t m = 0; m < columns; ++m)
        corner.row[m] = corner.along_x[m] * corner.along_y[static_cast<std::size_t>(r)];
    }
    std::vector<std::complex<double>> sum(columns);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const cv::Point2d d = edges_[e].b - edges_[e].a;
      const auto& from = corners_[ends_[e].first].row;
      const auto& to = corners_[ends_[e].second].row;
      for (std::size_t m = 0; m < columns; ++m) {
        const double kx = full_turn * static_cast<double>(m) / lattice_.period;
        const double kd = kx * d.x + ky * d.y, weight = -edges_[e].step * (kx * d.y - ky * d.x);
        if (std::abs(kd) > 1e-3) {
          sum[m] += weight / kd * (from[m] - to[m]);
        } else {
          // i exp(-i k.m) sinc(kd / 2); the next term is kd^4 / 1920.
          const cv::Point2d middle = (edges_[e].a + edges_[e].b) / 2;
          sum[m] += weight * (1 - kd * kd / 24) * std::complex<double>(0, 1) *
                    std::polar(1.0, -(kx * middle.x + ky * middle.y));
        }
      }
    }
    for (std::size_t m = 0; m < columns; ++m) {
      const double kx = full_turn * static_cast<double>(m) / lattice_.period;
      const double square = kx * kx + ky * ky;
      sum[m] = square > 0 ? sum[m] / square : std::complex<double>(integral(edges_));
    }
    return sum;
  }

 private:
  std::span<const StepEdge> edges_;
  FrequencyLattice lattice_;
  std::vector<Corner> corners_;
  std::vector<std::pair<std::size_t, std::size_t>> ends_;
};

}  // namespace

cv::Mat1d fine_step_image(std::span<const StepEdge> edges, const FilterTable& filter, int per_unit) {
  const FrequencyLattice lattice = filter.lattice();
  const int n = per_unit * lattice.period;
  CV_Assert(n > 2 * lattice.band);
  cv::Mat2d spectrum(n, n, cv::Vec2d(0, 0));
  EdgeSpectrum rows(edges, lattice);
  for (int r = 0; r <= 2 * lattice.band; ++r) {
    const auto values = rows.row(r, filter.extent(r));
    const int w = r - lattice.band;
    for (int m = 0; m < static_cast<int>(values.size()); ++m) {
      const std::complex<double> value = values[static_cast<std::size_t>(m)] * filter.values()(r, m);
      spectrum((w + n) % n, m) = {value.real(), value.imag()};
      if (m > 0) spectrum((n - w) % n, n - m) = {value.real(), -value.imag()};
    }
  }
  cv::Mat1d image;
  cv::dft(spectrum, image, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT);
  image /= static_cast<double>(lattice.period) * lattice.period;
  return image;
}

}  // namespace todbench
