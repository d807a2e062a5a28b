// SPDX-License-Identifier: GPL-3.0-or-later
// Answers over contrast whose truth is known in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/psychometric/ramp_fit.h"

namespace todbench::test {

/// A sensor whose S75 is sqrt(a^2 + (b / dT)^2), with a function that is logistic in ln size: P = 1/4 + 3/4 / (1 + 0.5
/// exp(-4 ln(S / S75))), 3/4 at S75.
struct LogisticSensor {
  double a = 2, b = 0.6;
  [[nodiscard]] double ln_s75(double delta_t_k) const { return std::log(std::hypot(a, b / delta_t_k)); }
  [[nodiscard]] double proportion(double ln_size, double delta_t_k) const {
    return 0.25 + 0.75 / (1 + 0.5 * std::exp(-4 * (ln_size - ln_s75(delta_t_k))));
  }
};

inline constexpr ContrastNoise sc2000_noise{.noise_k = 0.07, .internal_noise = 0.07};

/// `error`: standard deviation of the proportions of the tables, with random numbers of `seed`.
inline ContrastSurface surface_of(const LogisticSensor& sensor, double strongest_k, double weakest_k, double error = 0,
                                  std::uint64_t seed = 0) {
  const RandomStream random(seed, "tables");
  std::uint64_t draw = 0;
  std::vector<TableAtContrast> tables;
  for (const double delta_t_k : contrasts_of_surface(sc2000_noise, strongest_k, weakest_k)) {
    ProportionTable table;
    for (int i = -14; i <= 14; ++i) {
      const double ln_size = sensor.ln_s75(delta_t_k) + 0.08 * i;
      table.size_mrad.push_back(std::exp(ln_size));
      const double proportion = sensor.proportion(ln_size, delta_t_k) + (error > 0 ? error * random.normal(draw++) : 0);
      table.proportion_correct.push_back(std::clamp(proportion, 0.25, 1.0));
      table.standard_error.push_back(std::max(error, 1e-4));
    }
    tables.push_back({delta_t_k, table});
  }
  return ContrastSurface::of(tables, sc2000_noise).value();
}

/// Random errors of a run, standard deviations in ln size.
struct RampErrors {
  double of_set_up = 0;        ///< common to the answers of a set-up
  double of_presentation = 0;  ///< common to those of a presentation
  double contrast = 0;         ///< of the observed contrast, relative
  double up_against_down = 0;  ///< S75 of ramps up over that of ramps down, in ln
};

/// A run of eight set-ups with 20 contrasts down and 20 up, from 16.9 to 0.23 K, at ten sizes.
inline std::vector<RampAnswer> answers_of(const LogisticSensor& camera, const RampErrors& errors, std::uint64_t seed) {
  const RandomStream random(seed, "ramp");
  std::uint64_t draw = 0;
  std::vector<RampAnswer> out;
  constexpr int set_ups = 8, contrasts = 20;
  for (int g = 0; g < set_ups; ++g) {
    const double of_set_up = errors.of_set_up * random.normal(draw++);
    for (int k = 0; k < 2 * contrasts; ++k) {
      const bool up = k >= contrasts;
      const double share = (up ? 2 * contrasts - 1 - k : k) / (contrasts - 1.0);
      const double delta_t_k = 16.9 * std::pow(0.23 / 16.9, share);
      const double shift =
          of_set_up + errors.of_presentation * random.normal(draw++) + (up ? 0.5 : -0.5) * errors.up_against_down;
      const double observed_k = delta_t_k * (1 + errors.contrast * random.normal(draw++));
      for (int i = 0; i < 10; ++i) {
        const double ln_size = std::log(1.2) + 0.19 * i;
        const double mean = camera.proportion(ln_size - shift, delta_t_k);
        // A graded answer as the mean of nine right or wrong ones: a third of their scatter, and no bias at its ends.
        int right = 0;
        for (int one = 0; one < 9; ++one) right += random.uniform(draw++) < mean ? 1 : 0;
        const double answer = right / 9.0;
        out.push_back({.answer = {.size = std::exp(ln_size),
                                  .probability_correct = answer,
                                  .presentation = g * 2 * contrasts + k,
                                  .place = g * 10 + i,
                                  .set_up = g},
                       .delta_t_k = observed_k,
                       .direction = up ? RampDirection::up : RampDirection::down});
      }
    }
  }
  return out;
}

}  // namespace todbench::test
