// SPDX-License-Identifier: GPL-3.0-or-later
// Steps before a camera whose time constant is known: how often its interval is right.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "tod/measures/step_response.h"

namespace todbench::testing {

struct StepCase {
  double time_constant_s = 0.01, exposure_s = 0, frame_s = 0.02;
  int steps = 16, before = 8, after = 24;
  double step_k = 10, noise_k = 0.005;
  double correlation = 0;  ///< of the noise of successive frames
  double target_s = 0;     ///< first-order approach of the target itself; 0: at once
  double settling_s = 0;   ///< that is stated of it
};

/// Mean over an exposure that ends at `end_s` of what is left of a step at 0, 1 before it. Of two first orders in
/// series, where the target has one.
inline double left_of_step(const StepCase& one, double end_s) {
  const auto at = [&](double t) {
    if (t <= 0) return 1.0;
    const double tau = one.time_constant_s, target = one.target_s;
    if (target == 0) return std::exp(-t / tau);
    return (target * std::exp(-t / target) - tau * std::exp(-t / tau)) / (target - tau);
  };
  if (one.exposure_s == 0) return at(end_s);
  constexpr int parts = 400;
  double sum = 0;
  for (int i = 0; i < parts; ++i) sum += at(end_s - (i + 0.5) / parts * one.exposure_s) / parts;
  return sum;
}

inline std::vector<StepSeries> step_series(const StepCase& one, std::uint64_t seed) {
  const RandomStream random(seed, "test.steps");
  std::vector<float> draws(static_cast<std::size_t>(one.steps * (one.before + one.after + 1)));
  random.sub(1).fill_normal(draws);
  std::size_t used = 0;
  std::vector<StepSeries> out;
  for (int i = 0; i < one.steps; ++i) {
    StepSeries step{.rising = i % 2 == 0, .before = static_cast<std::size_t>(one.before), .time_s = {}, .signal = {}};
    // The frame clock does not know of the step.
    const double phase_s = one.frame_s * random.sub(2).uniform(static_cast<std::uint64_t>(i));
    double noise = draws[used++];
    for (int k = 0; k < one.before + one.after; ++k) {
      const double end_s = phase_s + (k - one.before) * one.frame_s;
      const double level = step.rising ? 1 - left_of_step(one, end_s) : left_of_step(one, end_s);
      noise = one.correlation * noise + std::sqrt(1 - one.correlation * one.correlation) * draws[used++];
      step.time_s.push_back(1 + k * one.frame_s);
      step.signal.push_back(0.3 + one.step_k * level + one.noise_k * noise);
    }
    out.push_back(std::move(step));
  }
  return out;
}

struct StepCoverage {
  int told = 0;           ///< seeds with a time constant
  double within = 0;      ///< part of these whose interval holds the truth
  double mean_error = 0;  ///< relative
  double half_width = 0;  ///< relative, mean
  int rises = 0, falls = 0;
  double rise_within = 0, fall_within = 0;
};

inline StepCoverage step_coverage(const StepCase& one, int seeds) {
  StepCoverage out;
  const double truth = one.time_constant_s;
  const auto holds = [&](const StepTimeConstant& found) { return found.low_s <= truth && truth <= found.high_s; };
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto found = step_response(step_series(one, static_cast<std::uint64_t>(seed)),
                                     {.frame_s = one.frame_s, .settling_s = one.settling_s});
    if (!found) continue;
    ++out.told;
    out.within += holds(found->both) ? 1 : 0;
    out.mean_error += found->both.value_s / truth - 1;
    out.half_width += 0.5 * (found->both.high_s - found->both.low_s) / truth;
    if (found->rise) ++out.rises, out.rise_within += holds(*found->rise) ? 1 : 0;
    if (found->fall) ++out.falls, out.fall_within += holds(*found->fall) ? 1 : 0;
  }
  if (out.told > 0) out.within /= out.told, out.mean_error /= out.told, out.half_width /= out.told;
  if (out.rises > 0) out.rise_within /= out.rises;
  if (out.falls > 0) out.fall_within /= out.falls;
  return out;
}

}  // namespace todbench::testing
