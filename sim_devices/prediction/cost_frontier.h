// What accuracy costs in time, measured on the machine on which it runs.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The 75 % size that one way of computing found at one contrast.
struct ThresholdEstimate {
  double delta_t_k = 0;
  double s75_pitch = 0;
  std::optional<double> standard_error_pitch{};  ///< as stated with it
};

/// One way of computing the thresholds, what it took and how far it was off.
struct CostPoint {
  std::string knob;     ///< "wavelengths", "phases", "wrap", "band", "draws", "trials", "tolerance", "planner"
  std::string setting;  ///< of the knob: "4", "1.5e-05", "5 %", "normal"
  bool paired = false;  ///< random numbers as its reference has them: the error is that of the knob alone
  std::optional<double> wall_s{};         ///< nothing, and nothing below: not measured
  std::optional<double> error_percent{};  ///< of the 75 % acuity against the reference, the largest over contrasts
  std::optional<double> standard_error_percent{};  ///< stated by the estimate, the largest over contrasts
  std::string not_measured{};                      ///< why, a clause; empty where it was
  bool chosen = false;                             ///< what the plan asks for
  bool best = false;  ///< of those not paired: nothing measured is both faster and nearer, standard error included

  [[nodiscard]] bool measured() const { return wall_s.has_value(); }
  /// What a result computed so may be off by: error and standard error together; paired: the error.
  [[nodiscard]] double total_percent() const {
    const double error = error_percent.value_or(0);
    return paired ? error : std::hypot(error, standard_error_percent.value_or(0));
  }
};

struct CostFrontier {
  std::vector<CostPoint> points;
  std::vector<ThresholdEstimate> reference;  ///< empty, and no points: no contrast has a threshold
  double reference_s = 0;                    ///< wall time of the reference
  int reference_draws = 0;
  int paired_draws = 0;  ///< of the paired points and of their reference
  double reference_standard_error_percent = 0;
  double budget_s = 0, spent_s = 0;
  std::vector<std::string> notes;  ///< sentences: contrasts without threshold, a reference cut to the budget
};

/// Effects and accuracy of a result that the program could give: a planner's choice.
struct CostChoice {
  std::string setting;
  SensorPlan effects;
  Accuracy accuracy;
  bool chosen = false;
};

/// Thresholds from trials, made by whoever can make trials.
struct CostTrials {
  std::string setting;       ///< "1920": so many trials
  double relative_cost = 1;  ///< compared with each other
  std::function<Result<std::vector<ThresholdEstimate>>(std::stop_token)> measure;
};

/// What is measured.
struct CostTask {
  SensorSpec sensor;
  SensorPlan full;  ///< every effect; with which the reference and the knobs are computed
  TemplateObserverSpec observer;
  SceneMotion motion{};
  std::vector<double> delta_t_k;
  std::vector<CostChoice> choices;  ///< knob "planner"
  std::vector<CostTrials> trials;   ///< knob "trials", cheap ones first
  std::uint64_t seed = 1;
  double budget_s = 60;  ///< wall time for all of it
  /// The time base of prices and budget; what runs when the budget ends is stopped by the host's clock.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// Called with what is done, and how many points of how many are through.
struct CostListener {
  std::function<void(std::string_view phase)> on_phase{};
  std::function<void(std::size_t done, std::size_t points)> on_progress{};
};

/// Estimates every threshold anew, template banks included, for the planner's choices and for each setting of each knob
/// of Accuracy alone, all others at the reference level.
///
/// The error of wavelengths, phases, wrap and band is taken against the reference level with as many draws as they
/// have, whose random numbers are the same, so that it is theirs alone. That of draws, trials, tolerance and planner is
/// taken against the whole reference; it holds what their random numbers happened to do, so their standard error stands
/// beside it. Wall times are of one thread and whatever else the machine does; the shorter of two where there is time.
///
/// The budget is kept: the reference uses no more than a third of it (with fewer draws where it must, and a note), a
/// point that will not fit, or does not, is left unmeasured and says so. The planner's chosen point comes first.
///
/// `invalid_input`: the budget is too short for the reference; `interrupted`.
[[nodiscard]] Result<CostFrontier> cost_frontier(const CostTask& task, const CostListener& listener,
                                                 std::stop_token stop);

}  // namespace todbench
