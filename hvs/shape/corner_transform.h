// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse Fourier transform for few output points. Sums are in a fixed order and bit-identical on every instruction
// set.
#pragma once

#include <complex>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

namespace todbench {

/// Returns exp(+2 pi i turns), with full accuracy for any number of turns.
[[nodiscard]] std::complex<double> turn(double turns);

/// Number of columns that are summed together in registers. Rows are padded to a multiple of this number.
inline constexpr std::size_t lanes = 16;

inline std::size_t whole_lanes(std::size_t columns) {
  return (columns + lanes - 1) / lanes * lanes;
}

/// A complex matrix with separate real and imaginary parts. Rows are padded with zeros to a multiple of `lanes`, so
/// that sums over rows can be vectorised.
struct SplitMatrix {
  std::size_t stride;
  std::vector<double> re, im;
  SplitMatrix(std::size_t rows, std::size_t columns) : stride(whole_lanes(columns)), re(rows * stride), im(re.size()) {}
};

/// Two numbers that are processed together in one register of every x86-64 processor (GCC and Clang). Without this
/// explicit type, the compiler pairs real with imaginary parts and spends more time on shuffles than on arithmetic. Do
/// not use vectors wider than the registers: GCC 12 keeps them in memory, which takes 13 to 40 times as long.
using Two = double __attribute__((vector_size(16)));
using TwoInMemory = double __attribute__((vector_size(16), aligned(8), may_alias));

/// Returns out[j][i] = Re sum_b sum_k folded[b][k] exp(2 pi i (b j + k i) / n), where n is `points`. The sums are over
/// the n rows b and the first n columns k; j and i are within `size`, periodic beyond n.
[[nodiscard]] cv::Mat1d corner_of_inverse(const SplitMatrix& folded, int points, cv::Size size);

}  // namespace todbench
