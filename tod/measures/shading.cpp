// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/shading.h"

#include <array>

namespace todbench {
namespace {

/// 1, x, y, x^2, x y, y^2 with x and y from -1 to 1.
std::array<double, 6> terms_at(const cv::Size& size, int x, int y) {
  const double u = 2.0 * x / (size.width - 1) - 1, v = 2.0 * y / (size.height - 1) - 1;
  return {1, u, v, u * u, u * v, v * v};
}

}  // namespace

Shading shading_of(const cv::Mat1d& picture) {
  const double mean = cv::mean(picture)[0];
  cv::Matx<double, 6, 6> squares = cv::Matx<double, 6, 6>::zeros();
  cv::Vec<double, 6> products = cv::Vec<double, 6>::all(0);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto terms = terms_at(picture.size(), x, y);
      for (int i = 0; i < 6; ++i) {
        const double term = terms[static_cast<std::size_t>(i)];
        products[i] += term * (picture(y, x) - mean);
        for (int j = 0; j < 6; ++j) squares(i, j) += term * terms[static_cast<std::size_t>(j)];
      }
    }
  }
  const cv::Vec<double, 6> factors = squares.solve(products, cv::DECOMP_CHOLESKY);
  Shading shading;
  shading.surface.create(picture.size());
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto terms = terms_at(picture.size(), x, y);
      double value = 0;
      for (int i = 0; i < 6; ++i) value += factors[i] * terms[static_cast<std::size_t>(i)];
      shading.surface(y, x) = value;
    }
  }
  shading.surface -= cv::mean(shading.surface)[0];
  double low = 0, high = 0;
  cv::minMaxLoc(shading.surface, &low, &high);
  cv::Scalar unused, sd;
  cv::meanStdDev(shading.surface, unused, sd);
  shading.range = high - low, shading.sd = sd[0];
  return shading;
}

}  // namespace todbench
