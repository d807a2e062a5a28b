// SPDX-License-Identifier: GPL-3.0-or-later
// People with known thresholds who choose between two intervals.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/measures/forced_choice.h"

namespace todbench::testing {

struct SimulatedChooser {
  double threshold_k = 0.03, exponent = 1.5, lapse = 0.01;
  double offset_k = 0;       ///< shown minus reported
  double set_up_sd = 0;      ///< of ln threshold between set-ups
  std::uint64_t frames = 0;  ///< seed of the set-ups; people with one value judge the same frames
};

/// Probability of a right answer to a reported contrast.
inline double probability_right(const SimulatedChooser& person, double contrast_k, int set_up) {
  const RandomStream set_ups(person.frames, "set-ups");
  const double ln_threshold =
      std::log(person.threshold_k) + person.set_up_sd * set_ups.normal(static_cast<std::uint64_t>(set_up));
  const double u = std::log(std::abs(contrast_k + person.offset_k)) - ln_threshold;
  const double seen = 0.5 * std::erfc(-0.6744897501960817 * std::exp(person.exponent * u) / std::numbers::sqrt2);
  return 0.5 * person.lapse + (1 - person.lapse) * seen;
}

/// Answers to the contrasts of a plan at eight set-ups, once each. Every seed has other set-ups.
inline std::vector<ForcedChoice> choices_of(SimulatedChooser person, std::uint64_t seed) {
  if (person.frames == 0) person.frames = 1000 + seed;
  const RandomStream random(seed, "choices");
  std::uint64_t number = 0;
  std::vector<ForcedChoice> out;
  for (int set_up = 0; set_up < 8; ++set_up) {
    for (int level = 0; level < 8; ++level) {
      for (const double sign : {1.0, -1.0}) {
        const double contrast_k = sign * 0.0025 * std::exp2(level);
        out.push_back({contrast_k, set_up, random.uniform(number++) < probability_right(person, contrast_k, set_up)});
      }
    }
  }
  return out;
}

}  // namespace todbench::testing
