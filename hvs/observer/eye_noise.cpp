// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/eye_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <tuple>
#include <utility>

#include "acquisition/base/multiversion.h"
#include "hvs/observer/block_product.h"
#include "hvs/observer/pivoted_cholesky.h"
#include "hvs/observer/template_bank.h"

namespace todbench {
namespace {

constexpr std::size_t eye_block = TemplateBank::block;

using Spectrum = cv::Mat_<std::complex<double>>;

/// Cosines and sines of 2 pi m d / (period steps) for displacements d = -most..most in search steps.
struct Waves {
  std::vector<double> cosine, sine;
  std::size_t width;
  Waves(int first, int count, int most, double period_steps) : width(static_cast<std::size_t>(2 * most + 1)) {
    for (int m = first; m < first + count; ++m) {
      for (int d = -most; d <= most; ++d) {
        const double angle = 2 * std::numbers::pi * m * d / period_steps;
        cosine.push_back(std::cos(angle));
        sine.push_back(std::sin(angle));
      }
    }
  }
};

/// Adds (x + i y) (cosine + i sine) to each element.
TODBENCH_MULTIVERSION
void add_turned(double x, double y, const double* cosine, const double* sine, std::size_t count, double* __restrict re,
                double* __restrict im) {
  for (std::size_t d = 0; d < count; ++d) {
    re[d] += x * cosine[d] - y * sine[d];
    im[d] += x * sine[d] + y * cosine[d];
  }
}

/// Adds the real part of (re + i im) (cosine + i sine) to each element.
TODBENCH_MULTIVERSION
void add_real_part(const double* re, const double* im, double cosine, double sine, std::size_t count,
                   double* __restrict sums) {
  for (std::size_t d = 0; d < count; ++d) sums[d] += re[d] * cosine - im[d] * sine;
}

/// Sum over the lattice of cross * exp(2 pi i (u dx + w dy)), real part, for all displacements: rows dy, columns dx.
std::vector<double> correlation(const Spectrum& cross, const FrequencyLattice& lattice, int most, int steps) {
  const double period_steps = static_cast<double>(lattice.period) * steps;
  const Waves along(0, lattice.band + 1, most, period_steps);
  const Waves down(-lattice.band, 2 * lattice.band + 1, most, period_steps);
  const std::size_t width = along.width;
  std::vector<double> out(width * width, 0), re(width), im(width);
  for (int r = 0; r < cross.rows; ++r) {
    std::fill(re.begin(), re.end(), 0.0);
    std::fill(im.begin(), im.end(), 0.0);
    const std::complex<double>* values = cross[r];
    for (int c = 0; c < cross.cols; ++c) {
      const double weight = c == 0 ? 1 : 2;  // the other half of the plane is conjugate
      const double x = weight * values[c].real(), y = weight * values[c].imag();
      if (x == 0 && y == 0) continue;
      const std::size_t at = static_cast<std::size_t>(c) * width;
      add_turned(x, y, &along.cosine[at], &along.sine[at], width, re.data(), im.data());
    }
    const double* cosine = &down.cosine[static_cast<std::size_t>(r) * width];
    const double* sine = &down.sine[static_cast<std::size_t>(r) * width];
    for (std::size_t j = 0; j < width; ++j)
      add_real_part(re.data(), im.data(), cosine[j], sine[j], width, &out[j * width]);
  }
  return out;
}

}  // namespace

EyeNoise::EyeNoise(EyeTemplates templates, const FilterTable& power) : templates_(std::move(templates)) {
  turned_ = power.turns_alike() && shapes_are_turned();
  tabulate(power);
  energy_ = covariance(0, 0);
  decompose();
}

bool EyeNoise::shapes_are_turned() const {
  if (alternatives() != 4) return false;
  for (std::size_t o = 1; o < 4; ++o) {
    for (const cv::Point2d& vertex : templates_.shapes[o - 1]) {
      const cv::Point2d expected{-vertex.y, vertex.x};
      const auto there = [&](const cv::Point2d& other) { return cv::norm(other - expected) < 1e-9; };
      if (std::ranges::none_of(templates_.shapes[o], there)) return false;
    }
  }
  return true;
}

void EyeNoise::tabulate(const FilterTable& power) {
  const FrequencyLattice& lattice = power.lattice();
  std::vector<Spectrum> spectra;
  for (const Polygon& shape : templates_.shapes) spectra.push_back(polygon_spectrum(shape, lattice));
  // <H F, H F'> in square degrees: an integral over frequencies in cycles per degree of spectra in square degrees.
  const double area = templates_.sample_deg * templates_.sample_deg / (1.0 * lattice.period * lattice.period);
  tables_.resize(alternatives() * alternatives());
  for (std::size_t first = 0; first < (turned_ ? 1 : alternatives()); ++first) {
    for (std::size_t second = first; second < alternatives(); ++second) {
      Spectrum cross(spectra[first].size());
      for (int r = 0; r < cross.rows; ++r) {
        for (int c = 0; c < cross.cols; ++c)
          cross(r, c) = area * power.values()(r, c) * spectra[first](r, c) * std::conj(spectra[second](r, c));
      }
      tables_[first * alternatives() + second] = correlation(cross, lattice, 2 * templates_.reach, templates_.steps);
    }
  }
}

double EyeNoise::covariance(std::size_t first, std::size_t second) const {
  const auto count = static_cast<std::size_t>(places());
  std::size_t one = first / count, other = second / count;
  const int side = 2 * templates_.reach + 1, most = 2 * templates_.reach;
  const int from = static_cast<int>(first % count), to = static_cast<int>(second % count);
  int dx = to % side - from % side, dy = to / side - from / side;
  if (turned_) {
    // Turned back until the first alternative is at the origin: (x, y) -> (y, -x) each.
    for (std::size_t quarter = 0; quarter < one; ++quarter) std::tie(dx, dy) = std::pair(dy, -dx);
    other = (other + 4 - one) % 4;
    one = 0;
  } else if (one > other) {
    std::swap(one, other);
    dx = -dx;
    dy = -dy;
  }
  const std::vector<double>& table = tables_[one * alternatives() + other];
  return table[static_cast<std::size_t>((dy + most) * (2 * most + 1) + dx + most)];
}

void EyeNoise::decompose() {
  const std::size_t count = alternatives() * static_cast<std::size_t>(places());
  std::vector<double> variances(count);
  for (std::size_t t = 0; t < count; ++t) variances[t] = covariance(t, t) / energy_;
  columns_ = pivoted_cholesky(std::move(variances), max_left_out, count, [&](std::size_t pivot) {
    std::vector<double> column(count);
    for (std::size_t t = 0; t < count; ++t) column[t] = covariance(pivot, t) / energy_;
    return column;
  });
  const std::size_t blocks = (count + eye_block - 1) / eye_block;
  factor_.assign(blocks * eye_block * rank(), 0.0F);
  for (std::size_t k = 0; k < rank(); ++k) {
    for (std::size_t t = 0; t < count; ++t)
      factor_[(t / eye_block * rank() + k) * eye_block + t % eye_block] = static_cast<float>(columns_[k][t]);
  }
}

double EyeNoise::sd(double contrast_k) const {
  const double contrast = shown_contrast(templates_.display, contrast_k);
  const double in_proportion = templates_.contrast_noise * contrast;
  return std::sqrt(energy_ * (1 + in_proportion * in_proportion * energy_)) / (contrast * templates_.template_scale);
}

double EyeNoise::sd(double contrast_k, double gain, double contrast_noise) const {
  // Products of the templates grow with the square of the sensitivity, and so does the scale of the bank.
  const double contrast = shown_contrast(templates_.display, contrast_k);
  const double fixed = energy_ / std::pow(gain * contrast, 2);
  return std::sqrt(fixed + std::pow(contrast_noise * energy_, 2)) / templates_.template_scale;
}

void EyeNoise::add(std::span<const float> numbers, float sd, std::span<float> scores) const {
  float sums[eye_block];
  for (std::size_t first = 0; first < scores.size(); first += eye_block) {
    block_product(factor_.data() + first * rank(), numbers.data(), rank(), sums);
    for (std::size_t t = 0; t < eye_block; ++t) scores[first + t] += sd * sums[t];
  }
}

}  // namespace todbench
