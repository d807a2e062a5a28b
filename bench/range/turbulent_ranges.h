// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges through turbulence. Its blur grows with the range, so the inputs of the models depend on their result.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/range/range_models.h"
#include "hvs/observer/template_observer.h"

namespace todbench {

/// Inputs of the range models behind a given turbulent path of constant Cn2. Immutable.
class TurbulentSources {
 public:
  /// `still` has a sensor. Thresholds of the TOD curve change like those of the simulated observer (survey_scene()), at
  /// paths up to `longest_m` with ln S75 linear between them; without an observer they stay. Formulas are computed
  /// anew; given curves are divided by the transfer function of the turbulence. Errors: `invalid_input` (Cn2 or path
  /// not above 0, or no sensor).
  [[nodiscard]] static Result<TurbulentSources> of(RangeSources still,
                                                   const std::optional<TemplateObserverSpec>& observer, double cn2,
                                                   double longest_m);

  /// A contrast without a threshold behind this turbulence is left out.
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

/// Returns the range that equals its own path; `range_behind` does not increase. Empty if it has no value.
[[nodiscard]] std::optional<double> self_consistent_range(
    double still_m, const std::function<std::optional<double>(double path_m)>& range_behind);

/// Decision about turbulence for the TOD model.
struct TurbulenceDecision {
  bool simulated = true;
  double bound_percent = 0;  ///< on the change of the acuity at the 75 % range
  std::string reason;        ///< a sentence
};
/// Decides like the planner of effects: turbulence is skipped if it changes the acuity by at most four fifths of the
/// tolerance, bounded at the range without turbulence.
[[nodiscard]] TurbulenceDecision decide_turbulence(const SensorSpec& sensor, double cn2, const RangeQuestion& question,
                                                   std::optional<double> still_r75_m, double tolerance_percent);

/// As range_models(): every range is solved with the curve behind its own path, P at every range is interpolated
/// between 16 paths. Sensitivities are those of the curve behind the 75 % range.
[[nodiscard]] Result<std::vector<ModelRange>> turbulent_range_models(std::span<const RangeModel> asked,
                                                                     const TurbulentSources& sources,
                                                                     const RangeQuestion& question);
/// The TOD model with notes, findings and points, as predict_range(), from thresholds without turbulence.
[[nodiscard]] Result<RangePrediction> turbulent_prediction(const TurbulentSources& sources,
                                                           std::span<const TodThreshold> still, const RangeTask& task);

}  // namespace todbench
