// What a plan will cost and how sure its result will be, before it is run.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "bench/plan/loaded_plan.h"
#include "bench/report/plot.h"
#include "bench/run/prediction.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// S75 that the simulated sensor of a plan lets expect at a contrast.
struct ExpectedThreshold {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;  ///< nothing: no size has a threshold at this contrast
};

/// By the direct estimate at draft accuracy: a second or so. Errors: `interrupted`.
[[nodiscard]] Result<std::vector<ExpectedThreshold>> expected_thresholds(const LoadedPlan& loaded,
                                                                         std::stop_token stop);
/// The same as a curve without intervals.
[[nodiscard]] TodCurve as_curve(const std::vector<ExpectedThreshold>& expected);

/// What predict_plan() and predict_times() say: some tenths of a second.
struct PlanForecast {
  Plan plan;                               ///< of which
  std::vector<int> frames;                 ///< per presentation, where it leaves them open: with_frames()
  SensorPlan effects;                      ///< the planner's decisions and reasons
  std::vector<std::string> warnings;       ///< a sentence each
  std::vector<ContrastPrediction> twin;    ///< with the phases of the simulation; empty: see `problem`
  std::vector<ContrastPrediction> camera;  ///< the same with the phases of the target
  /// Largest half-width of the camera with 1, 2, 4 and 8 frames per presentation; none of right and wrong answers.
  std::vector<std::pair<int, double>> by_frames;
  std::optional<double> twin_s;  ///< to simulate, on one core
  std::string problem;           ///< why the tolerance cannot be met; empty: it can
};

/// Errors: `interrupted`. `planner` remembers what only tolerance and trials leave as it is.
[[nodiscard]] Result<PlanForecast> forecast(const LoadedPlan& loaded, EffectPlanner& planner,
                                            std::stop_token stop = {});

struct PlannedContrast {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;                                              ///< of the first tier
  std::optional<double> camera_uncertainty_percent, twin_uncertainty_percent;  ///< half the 95 % interval of S75
};

struct PlanOutlook {
  std::uint64_t presentations = 0, trials = 0;  ///< of the camera; of an adaptive schedule what is expected
  double bench_s = 0;                           ///< as bench_time() (bench/run/bench_time.h)
  std::optional<double> twin_s;
  std::vector<PlannedContrast> contrasts;
  std::vector<std::pair<double, double>> by_frames;  ///< bench time and uncertainty of PlanForecast::by_frames
  /// Of the camera, the largest of the contrasts; nothing when one has no threshold.
  [[nodiscard]] std::optional<double> uncertainty_percent() const;
};

/// Cheap enough to follow a slider. Where the number of phases differs from that of the forecast, ln(1 + uncertainty)
/// and the time of the simulation are scaled: the one with the root of their ratio, the other with the ratio.
/// `seen` may be null: counts and bench time alone.
[[nodiscard]] PlanOutlook outlook(const Plan& plan, const std::vector<TargetPlate>& plates, const PlanForecast* seen,
                                  double frame_rate_hz);

/// The plan with another tolerance: as few phases, 2 to 256, for camera and twin as make every contrast that has a
/// threshold this sure; of an adaptive schedule, what is asked of it. `seen` may be null: phases stay.
[[nodiscard]] Plan with_tolerance(Plan plan, const PlanForecast* seen, double tolerance_percent);

/// One point of the frontier: the price of an accuracy.
struct AccuracyPrice {
  double tolerance_percent = 0;
  int phases = 0;
  double bench_s = 0;
  std::optional<double> twin_s;  ///< nothing: the simulation cannot be as good
};

/// predict_plan() and predict_times() for tolerances from 0.5 to 20 %; those that 256 phases do not reach are left out.
/// Ends early, with what there is, when stop is requested. Does not depend on tolerance and phases of the plan.
[[nodiscard]] std::vector<AccuracyPrice> accuracy_prices(const LoadedPlan& loaded, const PlanForecast& seen,
                                                         double frame_rate_hz, EffectPlanner& planner,
                                                         const std::stop_token& stop);

/// Uncertainty against time on the bench and time of the simulation, and of the same presentations with 1, 2, 4 and 8
/// frames; the plan itself is the square.
[[nodiscard]] Plot accuracy_plot(const std::vector<AccuracyPrice>& prices, const PlanOutlook& now);

}  // namespace todbench
