// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/edge_tails.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "acquisition/base/normal.h"

namespace todbench {
namespace {

using std::numbers::pi;
using namespace edge_tails;

constexpr double cauchy_slope = 2 * pi * cauchy_pitch;  // k
constexpr double least_noise = 3e-5;                    // of the step: the accuracy of the shapes
constexpr std::size_t slacks = 5;
constexpr double bound_sd = 1e-4;  // tolerance of a bound on a sum of unknowns
// Two degrees of freedom: most tails are 0, at a corner of the permitted region, at which the likelihood ratio exceeds
// that of one degree. With 3.84 the coverage at up to 0.25 cycles is 0.91 to 0.93, with this value 0.95 to 0.98.
constexpr double chi_square_95 = 5.991;
// Decrease of chi-square that shows negative shares. In 512 pictures without such shares (measures_study) no family
// decreased it by more.
constexpr double sure_undershoot = 20;
constexpr double sure_halo = 4;  // decrease of chi-square that shows halos beyond the default bound

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

/// The positive shares of the halos that belong to the MTF, and the contrast, in units of the samples.
struct HaloSum {
  double halos = 0, contrast = 0;
};

HaloSum halo_sum(const std::vector<double>& x, const TailBounds& bounds) {
  HaloSum sum{0, x[step]};
  for (std::size_t i = 0; i < halos; ++i) {
    if (wide(i, bounds))
      sum.contrast -= x[first_halo + i];
    else
      sum.halos += std::max(0.0, x[first_halo + i]);
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
  std::vector<double> padded = direction, out;
  padded.resize(unknowns_ + slacks, 0.0);
  double most = -HUGE_VAL;
  for (const Family& family : families_) {
    std::vector<double> x = family.problem->farthest(padded, chi_square_95 - family.above);
    const double reached = std::inner_product(direction.begin(), direction.end(), x.begin(), 0.0);
    if (reached > most) most = reached, out = std::move(x);
  }
  return out;
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
  square_ += pixels * value * value, pixels_ += pixels;
  rows_.insert(rows_.end(), columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(unknowns_));
  for (std::size_t i = 0; i < unknowns_; ++i) {
    right_[i] += pixels * columns[i] * value;
    for (std::size_t j = 0; j <= i; ++j) gram_[i * unknowns_ + j] += pixels * columns[i] * columns[j];
  }
}

TailFit::Family TailSamples::family(const TailBounds& bounds, std::size_t negative, double variance) const {
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
  rows[4][step] = bounds.most_undershoot;
  for (std::size_t k = 0; k < halos; ++k) {
    const std::size_t i = first_halo + k;
    rows[1][i] = bounds.least_slope_pitch, rows[2][i] = -bounds.most_slope_pitch;
    if (k < negative) {
      rows[4][i] = 1;
      continue;
    }
    rows[wide(k, bounds) ? 3 : 0][i] = -1;
    if (wide(k, bounds)) rows[0][i] = -bounds.most_halo;
  }
  for (std::size_t r = 0; r < slacks; ++r) {
    rows[r][unknowns_ + r] = -1;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) gram[i * n + j] += rows[r][i] * rows[r][j] / (bound_sd * bound_sd);
  }
  std::vector<double> low(n, -HUGE_VAL), high(n, HUGE_VAL);
  low[step] = 0.2, high[step] = 5;
  low[slope] = 0;
  for (std::size_t k = 0; k < halos; ++k) (k < negative ? high : low)[first_halo + k] = 0;
  std::fill(low.begin() + static_cast<std::ptrdiff_t>(unknowns_), low.end(), 0.0);
  return {negative, std::make_shared<BoundedLeastSquares>(gram, right, low, high), variance};
}

double TailSamples::squares_about(const std::vector<double>& x) const {
  double squares = square_;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    double row = -2 * right_[i];
    for (std::size_t j = 0; j < unknowns_; ++j) row += gram_[std::max(i, j) * unknowns_ + std::min(i, j)] * x[j];
    squares += x[i] * row;
  }
  return squares;
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

TailFit::Family TailSamples::settled(const TailBounds& bounds, std::size_t negative) const {
  double variance = 1e-4;
  for (int pass = 0; pass < 2; ++pass) variance = variance_about(family(bounds, negative, variance).problem->best());
  return family(bounds, negative, variance);
}

std::vector<TailFit::Family> TailSamples::families(const TailBounds& bounds, const TailFit::Family& positive,
                                                   double level_error) const {
  const auto squares = [&](const TailFit::Family& of) { return squares_about(of.problem->best()); };
  std::size_t narrow = 0;  // halos that may be negative
  while (narrow < halos && !wide(narrow, bounds)) ++narrow;
  std::size_t best = 0;
  double least = squares(positive);
  for (std::size_t negative = 1; negative <= narrow; ++negative) {
    const double found = squares(family(bounds, negative, positive.variance));
    if (found < least) least = found, best = negative;
  }
  if (best == 0) return {positive};
  std::vector<TailFit::Family> out{settled(bounds, best)};
  const double variance = out.front().variance;
  // The shapes are as accurate as the smallest noise that a fit assumes.
  const double gain = squares(positive) - squares(out.front());
  const double accuracy = std::max(level_error, least_noise);
  if (gain <= sure_undershoot * variance + pixels_ * accuracy * accuracy) return {positive};
  for (std::size_t negative = 1; negative <= narrow; ++negative) {
    if (negative == best) continue;
    TailFit::Family other = family(bounds, negative, variance);
    other.above = std::max(0.0, (squares(other) - squares(out.front())) / variance);
    if (other.above < chi_square_95) out.push_back(std::move(other));
  }
  return out;
}

std::optional<TailFit> TailSamples::fit(const TailBounds& bounds, double level_error) const {
  if (samples_.size() < 2 * unknowns_) return std::nullopt;
  const auto side = [&](bool bright) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < samples_.size(); ++k) count += (rows_[k * unknowns_ + step] > 0.5) == bright ? 1 : 0;
    return count;
  };
  if (side(false) < 10 || side(true) < 10) return std::nullopt;
  TailFit out;
  out.unknowns_ = unknowns_, out.bounds_ = bounds;
  TailFit::Family positive = settled(bounds, 0);
  if (bounds.most_halo_seen > bounds.most_halo) {
    TailBounds wider = bounds;
    wider.most_halo = bounds.most_halo_seen;
    TailFit::Family more = settled(wider, 0);
    const double gain = squares_about(positive.problem->best()) - squares_about(more.problem->best());
    if (gain > sure_halo * more.variance) out.bounds_ = wider, positive = std::move(more);
  }
  out.families_ = families(out.bounds_, positive, level_error);
  const TailFit::Family& best = out.families_.front();
  out.noise_ = std::sqrt(best.variance);
  std::vector<double> weaker(unknowns_ + slacks, 0.0);
  for (std::size_t k = 0; k < halos; ++k) weaker[first_halo + k] = k < best.negative ? 1 : -1;
  weaker[slope] = -1 / cauchy_slope;
  out.stated_ = best.problem->farthest(weaker, 1);
  return out;
}

}  // namespace todbench
