// Contrast that steps before a detector with memory.
#pragma once

#include <vector>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// What a detector of first order has taken in of a contrast that steps. Image formation is linear in the contrast, so
/// a picture of it at what is taken in is the picture of the step. All rows see it at the same moment.
class ContrastSteps {
 public:
  /// At `delta_t_k` for ever.
  explicit ContrastSteps(double delta_t_k = 0) : settled_k_(delta_t_k) {}

  /// To another contrast. Times rise.
  void step(double time_s, double delta_t_k);
  /// The mean over the exposure of the sensor that ends at `end_s`: its time constant follows the contrast as
  /// exp(-t / T). The contrast itself, bit for bit, where the detector has neither memory nor exposure, or long after
  /// the last step. Steps later than `end_s` are not seen yet.
  [[nodiscard]] double seen_k(double end_s, const SensorSpec& spec) const;
  /// Where the last step leads.
  [[nodiscard]] double last_k() const { return steps_.empty() ? settled_k_ : steps_.back().delta_t_k; }
  /// Whether a detector at `time_s` has nothing left of any step.
  [[nodiscard]] bool over(double time_s, const SensorSpec& spec) const;

 private:
  struct Step {
    double time_s = 0, delta_t_k = 0;
  };
  double settled_k_;
  std::vector<Step> steps_;
};

}  // namespace todbench
