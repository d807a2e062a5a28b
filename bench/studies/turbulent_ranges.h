// Ranges through turbulence, whose blur grows with the range: what the models read depends on their own answer.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/studies/range_models.h"
#include "hvs/observer/template_observer.h"

namespace todbench {

/// What the range models read, behind so much of a turbulent path of constant Cn2. Immutable.
class TurbulentSources {
 public:
  /// `still` has a sensor. The thresholds of the TOD curve are changed as those of the simulated observer are
  /// (survey_scene()), at paths up to `longest_m` between which ln S75 is linear; without an observer they stay.
  /// Formulas are computed anew; given curves are divided by the transfer of the turbulence. `invalid_input`: Cn2 or
  /// path not above 0, or no sensor.
  [[nodiscard]] static Result<TurbulentSources> of(RangeSources still,
                                                   const std::optional<TemplateObserverSpec>& observer, double cn2,
                                                   double longest_m);

  /// A contrast that has no threshold behind so much turbulence is left out.
  [[nodiscard]] std::vector<TodThreshold> thresholds_at(std::span<const TodThreshold> still, double path_m) const;
  [[nodiscard]] RangeSources at(double path_m) const;
  [[nodiscard]] SensorSpec sensor_at(double path_m) const;
  [[nodiscard]] const RangeSources& still() const { return still_; }
  [[nodiscard]] double longest_m() const { return longest_m_; }

 private:
  TurbulentSources() = default;
  [[nodiscard]] std::optional<double> ln_factor(double delta_t_k, double path_m) const;
  RangeSources still_;
  double cn2_ = 0, longest_m_ = 0;
  bool leaves_tod_ = false;
  std::vector<double> paths_m_;
  std::map<double, std::vector<std::optional<double>>> ln_factors_;  ///< by contrast, at `paths_m_`
};

/// The range that is its own path: `range_behind` does not increase. Nothing where it has no value.
[[nodiscard]] std::optional<double> self_consistent_range(
    double still_m, const std::function<std::optional<double>(double path_m)>& range_behind);

/// What was decided about turbulence for the TOD model, and why.
struct TurbulenceDecision {
  bool simulated = true;
  double bound_percent = 0;  ///< on the change of the acuity at the 75 % range
  std::string reason;        ///< a sentence
};
/// As the planner of effects decides: left out where the bound on the change of the acuity at the range that the curve
/// has without it is at most four fifths of the tolerance.
[[nodiscard]] TurbulenceDecision decide_turbulence(const SensorSpec& sensor, double cn2, const RangeQuestion& question,
                                                   std::optional<double> still_r75_m, double tolerance_percent);

/// As range_models(): every range solved with the curve behind its own path, P at every range between 16 paths.
/// Sensitivities are those of the curve behind the 75 % range.
[[nodiscard]] Result<std::vector<ModelRange>> turbulent_range_models(std::span<const RangeModel> asked,
                                                                     const TurbulentSources& sources,
                                                                     const RangeQuestion& question);
/// The TOD model with its notes, findings and points, as predict_range(), of thresholds without turbulence.
[[nodiscard]] Result<RangePrediction> turbulent_prediction(const TurbulentSources& sources,
                                                           std::span<const TodThreshold> still, const RangeTask& task);

}  // namespace todbench
