// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of the contrast in front of a detector with memory.
#pragma once

#include <vector>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Contrast that a first-order detector has reached after steps. Image formation is linear in the contrast, so a
/// picture during a step equals a steady picture at the reached contrast. All rows observe a step at the same moment.
class ContrastSteps {
 public:
  /// Creates a constant contrast `delta_t_k`, without a step.
  explicit ContrastSteps(double delta_t_k = 0) : settled_k_(delta_t_k) {}

  /// Adds a step at `time_s` (s) to the contrast `delta_t_k` (K). Times must increase from call to call.
  void step(double time_s, double delta_t_k);
  /// Returns the reached contrast in K, averaged over the exposure that ends at `end_s`. After a step, the distance
  /// from its contrast falls as exp(-t / T) with the time constant T of `spec`. Returns the set contrast bit for bit if
  /// T and the exposure are 0, or if over(). Steps later than `end_s` have no effect.
  [[nodiscard]] double seen_k(double end_s, const SensorSpec& spec) const;
  /// Returns the contrast after the last step.
  [[nodiscard]] double last_k() const { return steps_.empty() ? settled_k_ : steps_.back().delta_t_k; }
  /// Returns whether the detector of `spec` has settled at `time_s` (s) after all steps.
  [[nodiscard]] bool over(double time_s, const SensorSpec& spec) const;

 private:
  struct Step {
    double time_s = 0, delta_t_k = 0;
  };
  double settled_k_;
  std::vector<Step> steps_;
};

}  // namespace todbench
