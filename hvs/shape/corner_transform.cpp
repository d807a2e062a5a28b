// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/corner_transform.h"

#include <cmath>
#include <numbers>

#include "acquisition/base/multiversion.h"

namespace todbench {
namespace {

/// `lanes` columns of sum_b factor_b row_b, b = 0..rows-1 in this order.
TODBENCH_MULTIVERSION
void sum_rows(const double* matrix, std::size_t stride, const double* factors, std::size_t rows, double* sum) {
  constexpr std::size_t pairs = lanes / 2;
  Two sums[pairs] = {};
  for (std::size_t b = 0; b < rows; ++b) {
    const auto* row = reinterpret_cast<const TwoInMemory*>(matrix + b * stride);
    for (std::size_t l = 0; l < pairs; ++l) sums[l] += factors[b] * row[l];
  }
  auto* out = reinterpret_cast<TwoInMemory*>(sum);
  for (std::size_t l = 0; l < pairs; ++l) out[l] = sums[l];
}

}  // namespace

std::complex<double> turn(double turns) {
  const double angle = 2 * std::numbers::pi * (turns - std::nearbyint(turns));
  return {std::cos(angle), std::sin(angle)};
}

/// Cosines are even and sines odd in b, k, j and i: four sums of a quarter of the length, each over b or k in
/// increasing order.
cv::Mat1d corner_of_inverse(const SplitMatrix& folded, int points, cv::Size size) {
  const auto n = static_cast<std::size_t>(points);
  const std::size_t half = n / 2 + 1;
  const auto mirror = [n](std::size_t k) { return (n - k) % n; };
  const std::size_t stride = whole_lanes(half);
  std::vector<double> cosine(half * stride), sine(half * stride);  // [k][i]: of 2 pi k i / n
  {
    std::vector<std::complex<double>> roots(n);
    for (std::size_t i = 0; i < n; ++i) roots[i] = turn(static_cast<double>(i) / points);
    for (std::size_t k = 0; k < half; ++k) {
      for (std::size_t i = 0; i < half; ++i) {
        cosine[k * stride + i] = roots[k * i % n].real();
        sine[k * stride + i] = roots[k * i % n].imag();
      }
    }
  }
  // F_b + F_-b (a b that is its own mirror image counts once) is multiplied with cosines of b j, F_b - F_-b with sines.
  // Each holds first the part for the cosine of k i, then the part for minus the sine.
  const std::size_t wide = 2 * stride;
  std::vector<double> even(half * wide), odd(half * wide);
  for (std::size_t b = 0; b < half; ++b) {
    const std::size_t at = b * folded.stride, across = mirror(b) * folded.stride;
    const double twice = mirror(b) == b ? 0.5 : 1;
    for (std::size_t k = 0; k < half; ++k) {
      const std::size_t other = mirror(k);
      const double weight = twice * (other == k ? 0.5 : 1);
      const double re = folded.re[at + k], im = folded.im[at + k];
      const double re_y = folded.re[across + k], im_y = folded.im[across + k];
      const double re_x = folded.re[at + other], im_x = folded.im[at + other];
      const double re_xy = folded.re[across + other], im_xy = folded.im[across + other];
      even[b * wide + k] = weight * ((re + re_y) + (re_x + re_xy));
      odd[b * wide + k] = -weight * ((im - im_y) + (im_x - im_xy));
      even[b * wide + stride + k] = weight * ((im + im_y) - (im_x + im_xy));
      odd[b * wide + stride + k] = weight * ((re - re_y) - (re_x - re_xy));
    }
  }
  cv::Mat1d whole(points, points);
  std::vector<double> in_phase(wide), across(wide), sum(wide), cosines(stride), sines(stride);
  for (std::size_t j = 0; j < half; ++j) {
    for (std::size_t k = 0; k < wide; k += lanes) {
      sum_rows(&even[k], wide, &cosine[j * stride], half, &in_phase[k]);
      sum_rows(&odd[k], wide, &sine[j * stride], half, &across[k]);
    }
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t k = 0; k < wide; ++k) sum[k] = in_phase[k] + sign * across[k];
      for (std::size_t i = 0; i < stride; i += lanes) {
        sum_rows(&cosine[i], stride, sum.data(), half, &cosines[i]);
        sum_rows(&sine[i], stride, &sum[stride], half, &sines[i]);
      }
      double* row = whole[static_cast<int>(sign > 0 ? j : mirror(j))];
      for (std::size_t i = 0; i < half; ++i) {
        row[mirror(i)] = cosines[i] + sines[i];
        row[i] = cosines[i] - sines[i];
      }
    }
  }
  if (size == whole.size()) return whole;
  cv::Mat1d out(size);
  for (int j = 0; j < size.height; ++j) {
    for (int i = 0; i < size.width; ++i) out(j, i) = whole(j % points, i % points);
  }
  return out;
}

}  // namespace todbench
