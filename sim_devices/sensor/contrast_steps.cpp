// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/contrast_steps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace todbench {
namespace {

/// exp(-40) of a step is below the last digit of any contrast.
constexpr double forgotten_time_constants = 40;

/// Fraction of a step that is missing after `time_s`; 0 without memory.
double still_left(double time_s, double time_constant_s) {
  return time_constant_s > 0 ? std::exp(-time_s / time_constant_s) : 0;
}

}  // namespace

void ContrastSteps::step(double time_s, double delta_t_k) {
  steps_.push_back({time_s, delta_t_k});
}

bool ContrastSteps::over(double time_s, const SensorSpec& spec) const {
  const double long_s = 1e-3 * (forgotten_time_constants * spec.time_constant_ms + spec.exposure_ms);
  return steps_.empty() || time_s - steps_.back().time_s >= long_s;
}

double ContrastSteps::seen_k(double end_s, const SensorSpec& spec) const {
  if (over(end_s, spec)) return last_k();
  const double tau_s = 1e-3 * spec.time_constant_ms, exposure_s = 1e-3 * spec.exposure_ms;
  const double begin_s = end_s - exposure_s;
  // From step to step: the level at its start, and the part of the exposure after it.
  double level = settled_k_, towards = settled_k_, sum = 0;
  double from_s = steps_.empty() ? end_s : std::min(begin_s, steps_.front().time_s);
  for (std::size_t i = 0; i <= steps_.size(); ++i) {
    const double to_s = i < steps_.size() ? std::min(end_s, steps_[i].time_s) : end_s;
    const double a = std::max(from_s, begin_s), b = to_s;
    if (b > a) {
      const double away = tau_s * (still_left(a - from_s, tau_s) - still_left(b - from_s, tau_s));
      sum += towards * (b - a) + (level - towards) * away;
    }
    if (to_s > from_s) level = towards + (level - towards) * still_left(to_s - from_s, tau_s);
    if (i == steps_.size() || steps_[i].time_s >= end_s) break;
    from_s = std::max(from_s, to_s), towards = steps_[i].delta_t_k;
  }
  return exposure_s > 0 ? sum / exposure_s : level;
}

}  // namespace todbench
