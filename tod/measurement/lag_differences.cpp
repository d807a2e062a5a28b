// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/lag_differences.h"

#include <algorithm>

namespace todbench {
namespace {

/// Noise of first order that keeps more than 0.98 of its covariance over a lag cannot be distinguished from drift.
constexpr double most_ratio = 1.98;

}  // namespace

void LagDifferences::AtLag::add(const cv::Mat1d& difference) {
  cv::Scalar mean, sd;
  cv::meanStdDev(difference, mean, sd);
  squares += sd[0] * sd[0] / 2;
  ++pairs;
}

cv::Mat1d difference_of(const cv::Mat1d& from, const cv::Mat1d& to, FrameGain gain) {
  cv::Mat1d difference = to - from;
  if (gain == FrameGain::constant) return difference;
  cv::Mat1d scene = to + from;
  scene -= cv::mean(scene)[0];
  const double energy = scene.dot(scene);
  if (energy > 0) difference -= difference.dot(scene) / energy * scene;
  return difference;
}

LagDifferences::LagDifferences(int frames, FrameGain gain)
    : gain_(gain),
      references_(static_cast<std::size_t>(std::max(1, frames / 4))),
      lag_(static_cast<std::uint64_t>(std::max(1, 3 * frames / 8))) {}

void LagDifferences::add(std::uint64_t sequence, const cv::Mat1d& picture) {
  if (last_ && sequence == last_->sequence + 1) successive_.add(difference_of(last_->picture, picture, gain_));
  for (const Kept& kept : kept_) {
    if (sequence == kept.sequence + lag_) at_lag_.add(difference_of(kept.picture, picture, gain_));
    if (sequence == kept.sequence + 2 * lag_) at_twice_.add(difference_of(kept.picture, picture, gain_));
  }
  if (kept_.size() < references_) kept_.push_back({sequence, picture.clone()});
  last_ = Kept{sequence, picture.clone()};
}

double LagDifferences::variance() const {
  // Of noise of first order the differences at lags l and 2 l are 2 s^2 (1 - r) and 2 s^2 (1 - r^2), r = rho^l: their
  // ratio is 1 + r.
  if (at_lag_.pairs == 0 || at_twice_.pairs == 0 || !(at_lag_.mean() > 0)) return successive_variance();
  return at_lag_.mean() / (2 - std::clamp(at_twice_.mean() / at_lag_.mean(), 1.0, most_ratio));
}

double LagDifferences::memory() const {
  return successive_variance() > 0 ? variance() / successive_variance() : 1;
}

}  // namespace todbench
