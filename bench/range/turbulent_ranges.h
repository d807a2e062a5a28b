// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges through turbulence. The blur by turbulence increases with the range, so the inputs of the models depend on
// their result.
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

/// Inputs of the range models for a turbulent path of constant Cn2 and given length. Immutable.
class TurbulentSources {
 public:
  /// Prepares the sources. `still`: sources without turbulence, with a sensor. Thresholds of the TOD curve change by
  /// the same factor as the thresholds of the simulated observer (survey_scene()). This factor is computed at several
  /// paths up to `longest_m` and interpolated linearly in ln S75. Without an observer the thresholds do not change.
  /// Formulas are evaluated for each path. Given curves are divided by the transfer function of the turbulence. Errors:
  /// `invalid_input` (Cn2 or path not above 0, or no sensor).
  [[nodiscard]] static Result<TurbulentSources> of(RangeSources still,
                                                   const std::optional<TemplateObserverSpec>& observer, double cn2,
                                                   double longest_m);

  /// Returns the thresholds through a path of this length. A contrast without a threshold is left out.
  [[nodiscard]] std::vector<TodThreshold> thresholds_at(std::span<const TodThreshold> still, double path_m) const;
  /// Returns the sources for a path of this length.
  [[nodiscard]] RangeSources at(double path_m) const;
  /// Returns the sensor with a path of this length.
  [[nodiscard]] SensorSpec sensor_at(double path_m) const;
  /// Returns the sources without turbulence.
  [[nodiscard]] const RangeSources& still() const { return still_; }
  /// Returns the longest path, in m.
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

/// Solves R = range_behind(R) for a range of at most `still_m` and returns R. `range_behind`: range computed with the
/// turbulence of a path of this length. Precondition: `range_behind` does not increase. Empty if `range_behind` has no
/// value.
[[nodiscard]] std::optional<double> self_consistent_range(
    double still_m, const std::function<std::optional<double>(double path_m)>& range_behind);

/// Decision about turbulence for the TOD model.
struct TurbulenceDecision {
  bool simulated = true;
  double bound_percent = 0;  ///< upper bound on the change of the acuity at the 75 % range
  std::string reason;        ///< a sentence
};
/// Decides in the same way as the planner of effects. Turbulence is skipped if the bound on the change of the acuity,
/// at the range without turbulence, is at most four fifths of the tolerance.
[[nodiscard]] TurbulenceDecision decide_turbulence(const SensorSpec& sensor, double cn2, const RangeQuestion& question,
                                                   std::optional<double> still_r75_m, double tolerance_percent);

/// Evaluates the models as range_models() does, with turbulence. Each range is computed with the curve for a path of
/// that length. P is interpolated between 16 paths. Sensitivities are computed with the curve for the path of length
/// R75.
[[nodiscard]] Result<std::vector<ModelRange>> turbulent_range_models(std::span<const RangeModel> asked,
                                                                     const TurbulentSources& sources,
                                                                     const RangeQuestion& question);
/// Returns the prediction of the TOD model with notes, findings and points, as predict_range() does, from thresholds
/// without turbulence.
[[nodiscard]] Result<RangePrediction> turbulent_prediction(const TurbulentSources& sources,
                                                           std::span<const TodThreshold> still, const RangeTask& task);

}  // namespace todbench
