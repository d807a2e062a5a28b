// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/edge_tails.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/normal.h"

namespace todbench {
namespace {

using std::numbers::pi;
using namespace edge_tails;

constexpr double cauchy_slope = 2 * pi * cauchy_pitch;  // k
constexpr double least_noise = 3e-5;                    // of the step: the accuracy of the shapes
constexpr std::size_t slacks = 4;
constexpr double bound_sd = 1e-4;  // tolerance of a bound on a sum of unknowns
// Two degrees of freedom: most tails are 0, at a corner of the permitted region, at which the likelihood ratio exceeds
// that of one degree. With 3.84 the coverage at up to 0.25 cycles is 0.91 to 0.93, with this value 0.95 to 0.98.
constexpr double chi_square_95 = 5.991;

/// Share of a normal blur of unit sigma about x that lies in (-half, half).
double within(double x, double half) {
  return normal_probability(x + half) - normal_probability(x - half);
}

/// Corner value of the integral of c / (2 pi (x^2 + y^2 + c^2)^1.5).
double cauchy_corner(double x, double y) {
  return std::atan(x * y / (cauchy_pitch * std::sqrt(x * x + y * y + cauchy_pitch * cauchy_pitch))) / (2 * pi);
}

/// Whether a halo is a loss of contrast of the whole picture.
bool wide(std::size_t i, const TailBounds& bounds) {
  return halo_sigma_pitch(i) > bounds.widest_pitch;
}

/// The halos that belong to the MTF, in units of the samples, and as a share of the contrast.
struct HaloSum {
  double halos = 0, contrast = 0;
};

HaloSum halo_sum(const std::vector<double>& x, const TailBounds& bounds) {
  HaloSum sum{0, x[step]};
  for (std::size_t i = 0; i < halos; ++i) {
    if (wide(i, bounds))
      sum.contrast -= x[first_halo + i];
    else
      sum.halos += x[first_halo + i];
  }
  return sum;
}

void combine(double narrow, double cauchy, std::vector<double>& columns) {
  columns[level] = 1;
  columns[step] = narrow;
  columns[slope] = (cauchy - narrow) / cauchy_slope;
  for (std::size_t i = first_halo; i < first_shading; ++i) columns[i] -= narrow;
}

}  // namespace

double edge_tails::halo_sigma_pitch(std::size_t i) {
  constexpr double least = 2, most = 70;
  return least * std::pow(most / least, static_cast<double>(i) / (halos - 1));
}

void set_tail_columns(double t, std::vector<double>& columns) {
  for (std::size_t i = 0; i < halos; ++i) columns[first_halo + i] = normal_probability(t / halo_sigma_pitch(i));
  combine(normal_probability(t / narrow_sigma_pitch), 0.5 + std::atan(t / cauchy_pitch) / pi, columns);
}

void set_tail_columns(const std::vector<TailRectangle>& cut_outs, cv::Point2d at, std::vector<double>& columns) {
  std::fill(columns.begin(), columns.begin() + first_shading, 0.0);
  double narrow = 0, cauchy = 0;
  for (const TailRectangle& cut_out : cut_outs) {
    const double half_u = cv::norm(cut_out.half_u), half_v = cv::norm(cut_out.half_v);
    const double u = (at - cut_out.middle).dot(cut_out.half_u) / half_u;
    const double v = (at - cut_out.middle).dot(cut_out.half_v) / half_v;
    const auto blurred = [&](double sigma) {
      return within(u / sigma, half_u / sigma) * within(v / sigma, half_v / sigma);
    };
    narrow += blurred(narrow_sigma_pitch);
    cauchy += cauchy_corner(u + half_u, v + half_v) - cauchy_corner(u - half_u, v + half_v) -
              cauchy_corner(u + half_u, v - half_v) + cauchy_corner(u - half_u, v - half_v);
    for (std::size_t i = 0; i < halos; ++i) columns[first_halo + i] += blurred(halo_sigma_pitch(i));
  }
  combine(narrow, cauchy, columns);
}

std::array<double, first_shading> tail_transfer(double f, const TailBounds& bounds) {
  const auto normal = [&](double sigma) { return std::exp(-2 * pi * pi * sigma * sigma * f * f); };
  std::array<double, first_shading> out{};
  const double narrow = normal(narrow_sigma_pitch);
  out[step] = narrow;
  out[slope] = (std::exp(-cauchy_slope * f) - narrow) / cauchy_slope;
  for (std::size_t i = 0; i < halos; ++i)
    out[first_halo + i] = (wide(i, bounds) ? 0 : normal(halo_sigma_pitch(i))) - narrow;
  return out;
}

std::array<double, first_shading> tail_contrast(const TailBounds& bounds) {
  std::array<double, first_shading> out{};
  out[step] = 1;
  for (std::size_t i = 0; i < halos; ++i) out[first_halo + i] = wide(i, bounds) ? -1 : 0;
  return out;
}

TailBounds diffraction_bounds(double f_number, double mean_wavelength_um, double pitch_um) {
  const double expected = 4 / pi * mean_wavelength_um * f_number / pitch_um;
  TailBounds bounds;
  bounds.least_slope_pitch = 0.9 * expected, bounds.most_slope_pitch = 1.8 * expected;
  return bounds;
}

std::vector<double> TailFit::farthest(const std::vector<double>& direction) const {
  std::vector<double> padded = direction;
  padded.resize(unknowns_ + slacks, 0.0);
  return problem_->farthest(padded, chi_square_95);
}

bool TailFit::at_most_halo(const std::vector<double>& x) const {
  const HaloSum sum = halo_sum(x, bounds_);
  return sum.halos > 0.98 * bounds_.most_halo * sum.contrast;
}

double TailFit::halo_allowance() const {
  std::vector<double> direction(unknowns_, 0.0);
  for (std::size_t i = 0; i < halos; ++i) direction[first_halo + i] = wide(i, bounds_) ? 0 : 1;
  const HaloSum sum = halo_sum(farthest(direction), bounds_);
  return sum.halos / sum.contrast;
}

double TailFit::farthest_wide_share(double sign) const {
  std::vector<double> direction(unknowns_, 0.0);
  for (std::size_t i = 0; i < halos; ++i) direction[first_halo + i] = wide(i, bounds_) ? sign : 0;
  const std::vector<double> x = farthest(direction);
  return 1 - halo_sum(x, bounds_).contrast / x[step];
}

TailSamples::TailSamples(std::size_t shading_columns)
    : unknowns_(first_shading + shading_columns), gram_(unknowns_ * unknowns_), right_(unknowns_) {}

void TailSamples::add(const std::vector<double>& columns, double value, int pixels, std::size_t block) {
  samples_.push_back({value, pixels, block});
  rows_.insert(rows_.end(), columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(unknowns_));
  for (std::size_t i = 0; i < unknowns_; ++i) {
    right_[i] += pixels * columns[i] * value;
    for (std::size_t j = 0; j <= i; ++j) gram_[i * unknowns_ + j] += pixels * columns[i] * columns[j];
  }
}

TailFit TailSamples::fit_with(const TailBounds& bounds, double variance) const {
  const std::size_t n = unknowns_ + slacks;
  std::vector<double> gram(n * n), right(n);
  for (std::size_t i = 0; i < unknowns_; ++i) {
    right[i] = right_[i] / variance;
    for (std::size_t j = 0; j <= i; ++j) gram[i * n + j] = gram[j * n + i] = gram_[i * unknowns_ + j] / variance;
  }
  // Bounds on sums: a row that is 0 with a slack of at least 0.
  std::vector<std::vector<double>> rows(slacks, std::vector<double>(n));
  rows[0][step] = bounds.most_halo;
  rows[1][step] = -bounds.least_slope_pitch, rows[1][slope] = 1;
  rows[2][step] = bounds.most_slope_pitch, rows[2][slope] = -1;
  rows[3][step] = bounds.most_wide;
  for (std::size_t k = 0; k < halos; ++k) {
    const std::size_t i = first_halo + k;
    rows[wide(k, bounds) ? 3 : 0][i] = -1;
    rows[1][i] = bounds.least_slope_pitch, rows[2][i] = -bounds.most_slope_pitch;
    if (wide(k, bounds)) rows[0][i] = -bounds.most_halo;
  }
  for (std::size_t r = 0; r < slacks; ++r) {
    rows[r][unknowns_ + r] = -1;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) gram[i * n + j] += rows[r][i] * rows[r][j] / (bound_sd * bound_sd);
  }
  std::vector<double> low(n, -HUGE_VAL), high(n, HUGE_VAL);
  low[step] = 0.2, high[step] = 5;
  std::fill(low.begin() + slope, low.begin() + first_shading, 0.0);
  std::fill(low.begin() + static_cast<std::ptrdiff_t>(unknowns_), low.end(), 0.0);
  TailFit out;
  out.unknowns_ = unknowns_, out.bounds_ = bounds, out.noise_ = std::sqrt(variance);
  out.problem_ = std::make_shared<BoundedLeastSquares>(gram, right, low, high);
  std::vector<double> weaker(n, 0.0);
  std::fill(weaker.begin() + first_halo, weaker.begin() + first_shading, -1.0);
  weaker[slope] = -1 / cauchy_slope;
  out.stated_ = out.problem_->farthest(weaker, 1);
  return out;
}

double TailSamples::variance_about(const std::vector<double>& x) const {
  struct Block {
    double sum = 0, pixels = 0;
  };
  std::vector<Block> blocks;
  double squares = 0;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    double left = samples_[k].value;
    for (std::size_t i = 0; i < unknowns_; ++i) left -= rows_[k * unknowns_ + i] * x[i];
    squares += samples_[k].pixels * left * left;
    if (samples_[k].block >= blocks.size()) blocks.resize(samples_[k].block + 1);
    blocks[samples_[k].block].sum += samples_[k].pixels * left, blocks[samples_[k].block].pixels += samples_[k].pixels;
  }
  const double freedom = static_cast<double>(samples_.size()) - 10;  // tails at their bounds cost none
  const double variance = std::max(squares / freedom, least_noise * least_noise);
  double common = 0, count = 0;
  for (const Block& block : blocks)
    if (block.pixels > 0) common += block.sum * block.sum / (block.pixels * variance), count += 1;
  // White noise: 1 with a standard deviation of sqrt(2 / count).
  common /= std::max(1.0, count);
  return common > 1 + 3 * std::sqrt(2 / std::max(1.0, count)) ? variance * common : variance;
}

std::optional<TailFit> TailSamples::fit(const TailBounds& bounds) const {
  if (samples_.size() < 2 * unknowns_) return std::nullopt;
  const auto side = [&](bool bright) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < samples_.size(); ++k) count += (rows_[k * unknowns_ + step] > 0.5) == bright ? 1 : 0;
    return count;
  };
  if (side(false) < 10 || side(true) < 10) return std::nullopt;
  double variance = 1e-4;
  for (int pass = 0; pass < 2; ++pass) variance = variance_about(fit_with(bounds, variance).best());
  return fit_with(bounds, variance);
}

}  // namespace todbench
