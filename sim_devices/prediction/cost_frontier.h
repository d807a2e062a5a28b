// What accuracy costs in time, measured on the machine on which it runs.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/template_observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// One way of computing the thresholds, what it took and how far it was off.
struct CostPoint {
  std::string knob;     ///< "wavelengths", "phases", "wrap", "band", "draws", "planner"
  std::string setting;  ///< of the knob: "4", "1.5e-05", "normal"
  double wall_s = 0;
  double error_percent = 0;           ///< of the 75 % acuity against the reference, the largest over contrasts
  double standard_error_percent = 0;  ///< stated by the estimate, the largest over contrasts
  bool chosen = false;                ///< what the plan asks for
  bool best = false;                  ///< nothing measured is both faster and nearer
};

struct CostFrontier {
  std::vector<CostPoint> points;
  double reference_s = 0;                       ///< wall time of the reference
  double reference_standard_error_percent = 0;  ///< of the reference, the largest over contrasts
};

/// What is varied and from where.
struct CostTask {
  SensorSpec sensor;
  SensorPlan full;     ///< every effect; with which the reference and the knobs are computed
  SensorPlan planned;  ///< the planner's choice
  TemplateObserverSpec observer;
  SceneMotion motion{};
  std::vector<double> delta_t_k;
  Accuracy chosen;             ///< each knob alone is varied from here
  std::string chosen_setting;  ///< its name; "normal"
  std::uint64_t seed = 1;
};

/// Estimates every threshold anew, template banks included, for each setting of each knob alone (the others as chosen)
/// and for the planner's choice of effects at draft, normal, reference and as chosen. The error of wavelengths, phases,
/// wrap and band is taken against the reference level with as many draws as chosen, whose random numbers are the same,
/// so that it is theirs alone; that of draws and of the planner against the whole reference, the error of its draws
/// included. Wall times are those of one thread and whatever else the machine does. `on_progress` is called after each
/// setting. Errors as direct_estimate(); `interrupted`.
[[nodiscard]] Result<CostFrontier> cost_frontier(const CostTask& task,
                                                 const std::function<void(std::size_t, std::size_t)>& on_progress,
                                                 std::stop_token stop);

}  // namespace todbench
