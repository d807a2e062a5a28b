// SPDX-License-Identifier: GPL-3.0-or-later
// Computing time against accuracy, measured on this computer.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The 75 % size at one contrast, computed in one way.
struct ThresholdEstimate {
  double delta_t_k = 0;
  double s75_pitch = 0;
  std::optional<double> standard_error_pitch{};  ///< as reported by the estimate
};

/// One way of computing the thresholds, with its time and its error. The computing time is the time of one thread on an
/// idle machine: the smaller of wall time and processor time.
struct CostPoint {
  std::string knob;     ///< "wavelengths", "phases", "wrap", "band", "draws", "trials", "tolerance", "planner"
  std::string setting;  ///< value of the knob: "4", "1.5e-05", "5 %", "normal"
  bool paired = false;  ///< same random numbers as its reference: the error comes from the setting only
  std::optional<double> wall_s{};         ///< computing time; if not measured, it and the next two values are empty
  std::optional<double> error_percent{};  ///< of the 75 % acuity against the reference; the largest over contrasts
  std::optional<double> standard_error_percent{};  ///< reported by the estimate; the largest over contrasts
  std::string not_measured{};                      ///< reason, a clause; empty if measured
  bool chosen = false;                             ///< selected by the plan
  /// True if no measured point without `paired` is both faster and more accurate, standard error included.
  bool best = false;

  [[nodiscard]] bool measured() const { return wall_s.has_value(); }
  /// Returns the possible deviation of a result in percent: sqrt(error^2 + standard error^2), or the error if `paired`
  /// is true.
  [[nodiscard]] double total_percent() const {
    const double error = error_percent.value_or(0);
    return paired ? error : std::hypot(error, standard_error_percent.value_or(0));
  }
};

/// Measured points, with the reference to which their errors relate.
struct CostFrontier {
  std::vector<CostPoint> points;
  std::vector<ThresholdEstimate> reference;  ///< empty, like `points`, if no contrast has a threshold
  double reference_s = 0;                    ///< computing time of the reference
  int reference_draws = 0;
  int paired_draws = 0;  ///< draws of the paired points and of their reference
  double reference_standard_error_percent = 0;
  double budget_s = 0, spent_s = 0;
  std::vector<std::string> notes;  ///< sentences: contrasts without threshold, a reference reduced to fit the budget
};

/// One choice of the planner: the effects that are simulated, and the accuracy.
struct CostChoice {
  std::string setting;
  SensorPlan effects;
  Accuracy accuracy;
  bool chosen = false;
};

/// Thresholds from trials, computed by the caller.
struct CostTrials {
  std::string setting;       ///< number of trials: "1920"
  double relative_cost = 1;  ///< cost relative to the other entries
  std::function<Result<std::vector<ThresholdEstimate>>(std::stop_token)> measure;
};

/// The task that is measured.
struct CostTask {
  SensorSpec sensor;
  SensorPlan full;  ///< every effect; used for the reference and the knobs
  TemplateObserverSpec observer;
  SceneMotion motion{};
  std::vector<double> delta_t_k;    ///< contrasts whose thresholds are estimated
  std::vector<CostChoice> choices;  ///< knob "planner"
  std::vector<CostTrials> trials;   ///< knob "trials"; cheap settings first
  std::uint64_t seed = 1;
  double budget_s = 60;  ///< wall time for the whole task
  /// Time base of costs and budget. The host's clock stops work that still runs at the end of the budget.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// Callbacks for the name of the present phase, and for the numbers of completed points and of all points.
struct CostListener {
  std::function<void(std::string_view phase)> on_phase{};
  std::function<void(std::size_t done, std::size_t points)> on_progress{};
};

/// Estimates every threshold for the planner's choices and for each value of each setting of Accuracy (knob). Only one
/// setting is varied at a time; the others keep the reference value.
///
/// The error of wavelengths, phases, wrap and band is relative to the reference level with the same number of draws and
/// the same random numbers. This error therefore comes from the setting only. The error of draws, trials, tolerance and
/// planner is relative to the reference itself and contains the variation of the random numbers, so their standard
/// error is also reported. Computing times are the shorter of two runs if there is time.
///
/// The time budget is never exceeded. The reference uses at most a third of the budget. If necessary it uses fewer
/// draws and adds a note. A point that does not fit into the budget is left unmeasured, with a reason. The planner's
/// chosen point comes first.
///
/// Errors: `invalid_input` (the budget is too short for the reference), `interrupted`.
[[nodiscard]] Result<CostFrontier> cost_frontier(const CostTask& task, const CostListener& listener,
                                                 std::stop_token stop);

}  // namespace todbench
