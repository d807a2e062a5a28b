// SPDX-License-Identifier: GPL-3.0-or-later
// How much direct estimates scatter over seeds, and what they say of it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <vector>

#include "sim_devices/prediction/direct_estimate.h"
#include "tod/plate/test_pattern.h"

namespace todbench::testing {

/// Of one contrast, over seeds; in percent of S75, where it is one.
struct DirectScatter {
  double delta_t_k = 0, mean_ln_s75 = 0, scatter_percent = 0, stated_percent = 0;
  int fewest_draws = 0, most_draws = 0;
  /// What is stated, at the mean square, is what is seen where this is 1; its standard error is 1 / sqrt(2 runs).
  [[nodiscard]] double ratio() const { return scatter_percent / stated_percent; }
};

/// The seeds are first_seed, first_seed + 1, ... `seconds`: processor time of one estimate of all contrasts.
inline std::vector<DirectScatter> direct_scatter(const SensorSpec& spec, const std::vector<double>& contrasts,
                                                 const Accuracy& accuracy, int runs, std::uint64_t first_seed,
                                                 double* seconds = nullptr) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorPlan plan = full_plan(spec, {}, {});
  std::vector<DirectScatter> out(contrasts.size());
  std::vector<double> squares(contrasts.size());
  const std::clock_t begin = std::clock();
  for (int run = 0; run < runs; ++run) {
    const auto points = direct_estimate(spec, plan, observer, contrasts,
                                        {.accuracy = accuracy, .seed = first_seed + static_cast<std::uint64_t>(run)});
    EXPECT_TRUE(points.has_value()) << (points ? "" : points.error().message);
    if (!points) return {};
    for (std::size_t c = 0; c < contrasts.size(); ++c) {
      const DirectPoint& point = (*points)[c];
      const double x = std::log(point.s75_pitch);
      out[c].delta_t_k = contrasts[c];
      out[c].mean_ln_s75 += x / runs;
      squares[c] += x * x;
      out[c].stated_percent += std::pow(100 * point.standard_error_pitch / point.s75_pitch, 2) / runs;
      out[c].fewest_draws = run == 0 ? point.noise_draws : std::min(out[c].fewest_draws, point.noise_draws);
      out[c].most_draws = std::max(out[c].most_draws, point.noise_draws);
    }
  }
  if (seconds != nullptr) *seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / runs;
  for (std::size_t c = 0; c < contrasts.size(); ++c) {
    const double mean = out[c].mean_ln_s75;
    out[c].scatter_percent = 100 * std::sqrt((squares[c] - runs * mean * mean) / (runs - 1));
    out[c].stated_percent = std::sqrt(out[c].stated_percent);
  }
  return out;
}

}  // namespace todbench::testing
