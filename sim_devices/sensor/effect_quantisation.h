// SPDX-License-Identifier: GPL-3.0-or-later
// Rounding to whole counts. No other code rounds a picture.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the temporal noise of a displayed sample in counts, before rounding.
[[nodiscard]] double noise_in_counts(const SensorSpec& spec);
/// Returns whether a count is larger than one standard deviation of the noise. For a smaller count, rounding errors act
/// as additional noise with a variance of 1/12 squared count, accurate to 3e-9 of a count. For a larger count, rounding
/// errors depend on the signal.
[[nodiscard]] bool rounds_coarsely(const SensorSpec& spec);
/// Returns whether the surround or a target of this contrast is less than six standard deviations of the noise
/// (temporal and fixed pattern) away from the lowest or highest count. `background_k`: temperature of the surround.
[[nodiscard]] bool reaches_an_end(const SensorSpec& spec, double delta_t_k, double background_k);

/// Rounds kelvin above the surround to the counts of a sensor, halves upwards. The steps of counts are at fixed
/// temperatures, wherever the surround lies within its count. Immutable; any thread.
class Quantiser {
 public:
  Quantiser(const SensorSpec& spec, double background_k)
      : step_k_(spec.kelvin_per_count),
        per_kelvin_(1 / spec.kelvin_per_count),
        background_((background_k - spec.offset_k) * per_kelvin_),
        half_up_(background_ + 0.5),
        full_scale_(static_cast<double>((1u << spec.bits) - 1u) + 0.5) {}

  /// Returns the count, clipped to the significant bits.
  [[nodiscard]] std::uint16_t count(float kelvin) const {
    return static_cast<std::uint16_t>(static_cast<int>(std::clamp(level(kelvin), 0.0, full_scale_)));
  }
  /// Returns the temperature of the unclipped count, in kelvin above the surround.
  [[nodiscard]] float rounded(float kelvin) const {
    return static_cast<float>((std::floor(level(kelvin)) - background_) * step_k_);
  }
  /// Returns the temperature of the clipped count, as a frame shows it.
  [[nodiscard]] float shown(float kelvin) const {
    return static_cast<float>((std::floor(std::clamp(level(kelvin), 0.0, full_scale_)) - background_) * step_k_);
  }
  /// Mean and standard deviation of shown(), for normal noise of `sd_k` about `kelvin`.
  struct Reading {
    double mean_k = 0, sd_k = 0;
  };
  [[nodiscard]] Reading reading(double kelvin, double sd_k) const;

 private:
  /// Returns the level in counts plus 1/2; its integer part is the count.
  [[nodiscard]] double level(float kelvin) const { return half_up_ + static_cast<double>(kelvin) * per_kelvin_; }

  double step_k_, per_kelvin_, background_, half_up_, full_scale_;
};

}  // namespace todbench
