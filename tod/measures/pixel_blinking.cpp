// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/pixel_blinking.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tod/measures/medians.h"

namespace todbench {
namespace {

constexpr int most_stretches = 64, least_class = 3;

/// Largest difference from 0 of the mean of successive stretches, over its standard uncertainty for a noise of 1 per
/// frame: the scan for one episode on another level. A single step is an episode that lasts to the end.
double largest_episode(const float* values, int frames, std::vector<double>& sums) {
  const int per_stretch = (frames + most_stretches - 1) / most_stretches;
  const int stretches = frames / per_stretch;
  sums.assign(static_cast<std::size_t>(stretches) + 1, 0);
  for (int s = 0; s < stretches; ++s) {
    double sum = 0;
    for (int t = s * per_stretch; t < (s + 1) * per_stretch; ++t) sum += values[t];
    sums[static_cast<std::size_t>(s) + 1] = sums[static_cast<std::size_t>(s)] + sum;
  }
  const double mean = sums.back() / stretches;
  const int least = std::max(1, (least_class + per_stretch - 1) / per_stretch);
  double largest = 0;
  for (int length = least; length <= stretches - least; ++length) {
    const double variance = static_cast<double>(per_stretch) * length * (1 - static_cast<double>(length) / stretches);
    double square = 0;
    for (int first = 0; first + length <= stretches; ++first) {
      const double sum =
          sums[static_cast<std::size_t>(first + length)] - sums[static_cast<std::size_t>(first)] - length * mean;
      square = std::max(square, sum * sum);
    }
    largest = std::max(largest, square / variance);
  }
  return std::sqrt(largest);
}

double noise_of_successive(const float* values, int frames) {
  double squares = 0;
  for (int t = 1; t < frames; ++t) squares += std::pow(values[t] - values[t - 1], 2);
  return std::sqrt(squares / (2.0 * (frames - 1)));
}

struct Levels {
  double apart = 0, within = 0;  ///< difference of the means; pooled standard deviation
};

/// The partition into two classes with the least variance within them (Otsu 1979, without bins).
Levels two_levels(const float* values, int frames, std::vector<float>& sorted) {
  sorted.assign(values, values + frames);
  std::sort(sorted.begin(), sorted.end());
  double total = 0, squares = 0;
  for (const float value : sorted) total += value, squares += static_cast<double>(value) * value;
  double below = 0, best = -1, apart = 0;
  for (int n = 1; n <= frames - least_class; ++n) {
    below += sorted[static_cast<std::size_t>(n) - 1];
    if (n < least_class) continue;
    const double difference = (total - below) / (frames - n) - below / n;
    const double between = static_cast<double>(n) * (frames - n) / frames * difference * difference;
    if (between > best) best = between, apart = difference;
  }
  const double within = squares - total * total / frames - best;
  return {apart, std::sqrt(std::max(0.0, within) / (frames - 2))};
}

}  // namespace

cv::Mat1b blinking_pixels(const cv::Mat1f& series, cv::Size size, const BlinkingRules& rules) {
  const int frames = series.cols;
  CV_Assert(frames >= 16 && series.rows == size.area() && series.isContinuous());
  cv::Mat1d episode = cv::Mat1d::zeros(size);
  cv::Mat1b blinking = cv::Mat1b::zeros(size);
  std::vector<double> sums;
  std::vector<float> sorted;
  for (int p = 0; p < series.rows; ++p) {
    const float* values = series[p];
    const cv::Point at(p % size.width, p / size.width);
    const double noise = noise_of_successive(values, frames);
    // Rounding may keep a pixel constant for a while: its noise counts as at least half of the median pixel's.
    episode(at) = largest_episode(values, frames, sums) / std::max(noise, 0.5 * rules.noise_sd);
    const Levels levels = two_levels(values, frames, sorted);
    if (levels.apart > rules.levels * std::max(levels.within, rules.noise_sd)) blinking(at) = 255;
  }
  blinking |= episode > rules.medians * median_of(episode);
  return blinking;
}

}  // namespace todbench
