// SPDX-License-Identifier: GPL-3.0-or-later
// How often the paired interval of a ratio holds the true ratio, from answers whose functions are known.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "bench/enhance/enhancement.h"

namespace todbench::testing {

/// One experiment: presentations of two triangles of each of ten sizes, answered twice.
struct CoverageDesign {
  int presentations = 24;
  double ratio = 1.1;          ///< acuity with over acuity without
  double shared_noise = 0.7;   ///< share of the triangles that both answer from the same random number
  double presentation_sd = 0;  ///< sd of ln threshold from presentation to presentation, common to both
};
struct Coverage {
  int intervals = 0, holding = 0;
  double mean_half_width = 0;  ///< of ln ratio
};

/// Weibull function in size, slope 3.5, 25 % by guessing.
inline double proportion_at(double size, double s75) {
  return 0.25 + 0.75 * (1 - std::exp(-std::log(3.0) * std::pow(size / s75, 3.5)));
}

inline Coverage coverage_of(const CoverageDesign& design, int runs, std::uint64_t seed) {
  Coverage found;
  for (int run = 0; run < runs; ++run) {
    const RandomStream numbers = RandomStream(seed, "coverage").sub(static_cast<std::uint64_t>(run));
    std::vector<Trial> with, without;
    std::uint64_t next = 0;
    std::vector<float> shifts(static_cast<std::size_t>(design.presentations));
    numbers.sub(1).fill_normal(shifts);
    for (int p = 0; p < design.presentations; ++p) {
      const double shift = std::exp(design.presentation_sd * shifts[static_cast<std::size_t>(p)]);
      for (int t = 0; t < 20; ++t) {
        Trial trial;
        trial.presentation = p;
        trial.set_delta_t_k = 2;
        trial.size_mrad = 0.5 * std::pow(1.18, t / 2);
        const double own = numbers.uniform(next), another = numbers.uniform(next + 1);
        const bool same = numbers.uniform(next + 2) < design.shared_noise;
        next += 3;
        const auto answer = [&](double s75, double number) {
          return number < proportion_at(trial.size_mrad, s75) ? Apex::up : Apex::down;
        };
        trial.answer = answer(shift, own);
        without.push_back(trial);
        trial.answer = answer(shift / design.ratio, same ? own : another);
        with.push_back(trial);
      }
    }
    const auto ratios = paired_ratios(with, without, {});
    if (ratios.size() != 1 || !ratios[0].ci95.low || !ratios[0].ci95.high) continue;
    ++found.intervals;
    found.holding += *ratios[0].ci95.low <= design.ratio && design.ratio <= *ratios[0].ci95.high ? 1 : 0;
    found.mean_half_width += std::log(*ratios[0].ci95.high / *ratios[0].ci95.low) / 2;
  }
  if (found.intervals > 0) found.mean_half_width /= found.intervals;
  return found;
}

}  // namespace todbench::testing
