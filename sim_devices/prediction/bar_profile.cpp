// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/bar_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace todbench {

std::vector<float> bar_profile(const cv::Mat1f& window, double frequency_per_sample, BarAxis axis) {
  const cv::Mat1f turned = axis == BarAxis::horizontal ? window : cv::Mat1f(window.t());
  const double half_length = 1.75 / frequency_per_sample;
  // Ends of bars are blurred: the last sample is left out if enough samples remain.
  const int most = turned.rows / 2;
  const int half = std::clamp(static_cast<int>(half_length - 1), 1, most);
  cv::Mat1f mean;
  cv::reduce(turned.rowRange(most - half, most + half), mean, 0, cv::REDUCE_AVG, CV_32F);
  return {mean.begin(), mean.end()};
}

double shallowest_gap(std::span<const double> profile, double frequency_per_sample, double offset) {
  const double width = 1 / (2 * frequency_per_sample), reach = std::max(width / 2, 0.5);
  const double middle = (static_cast<double>(profile.size()) - 1) / 2 + offset;
  constexpr double edge = 1e-9;
  const auto extreme = [&](double centre, bool largest) {
    double found = largest ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    const auto first = static_cast<std::ptrdiff_t>(std::ceil(middle + centre - reach - edge));
    const auto last = static_cast<std::ptrdiff_t>(std::floor(middle + centre + reach + edge));
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(first, 0);
         k <= std::min(last, static_cast<std::ptrdiff_t>(profile.size()) - 1); ++k) {
      const double value = profile[static_cast<std::size_t>(k)];
      found = largest ? std::max(found, value) : std::min(found, value);
    }
    return found;
  };
  std::array<double, 4> bars{};
  for (std::size_t i = 0; i < bars.size(); ++i) bars[i] = extreme((2 * static_cast<double>(i) - 3) * width, true);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const double gap = extreme((2 * static_cast<double>(i) - 2) * width, false);
    least = std::min(least, std::min(bars[i], bars[i + 1]) - gap);
  }
  return least;
}

}  // namespace todbench
