// SPDX-License-Identifier: GPL-3.0-or-later
// Search for the design with the least bench time for a half-width or for the decisions of a plan.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/forecast/prediction.h"
#include "bench/plan/plan.h"
#include "bench/twin/experiment_inputs.h"

namespace todbench {

/// Least number of phases of a design.
inline constexpr int least_design_phases = 3;

/// A design replaces another one if its bench time is smaller than this share of the other bench time.
inline constexpr double least_design_gain = 0.995;

/// Requirement on a design.
struct DesignRequest {
  /// Half-width of the 95 % interval of S75 from the trials at every contrast. 19 of 20 runs do not exceed this
  /// half-width. Empty: the half-width of the plan as it is.
  std::optional<double> half_width_percent{};
  /// If true, every limit on an acuity is decided with a probability of 95 % if the camera equals the simulated sensor.
  /// `half_width_percent` is then not used. The half-width at every contrast is at most 10 %, and at most a third of
  /// the equivalence margin if the plan states one.
  bool decide = false;
};

/// Design with its prediction.
struct PricedDesign {
  Plan plan;
  double bench_s = 0;                          ///< laboratory_time(): changes, frames, corrections; without computing
  double changes_s = 0;                        ///< part of bench_s that changes of the target take
  int set_ups = 0;                             ///< set-ups that the run is expected to show
  std::optional<double> half_width_percent{};  ///< largest half-width over the contrasts
  std::vector<ContrastPrediction> contrasts{};
};

/// Ramp over the contrasts of a plan.
struct RampDesign {
  PricedDesign design;
  double lag_s = 0;  ///< lag of the plate, stated in the plan or assumed
  bool lag_is_stated = false;
  bool meets = false;  ///< the design meets the request; if not, it has all set-ups at the largest rate
};

/// Best design, the plan as it was, and alternatives of other kinds.
struct BestDesign {
  PricedDesign as_planned, best;
  bool planned_meets = false;  ///< whether `as_planned` meets the request
  double least_s = 0;          ///< bench time of the fastest design examined, regardless of its half-width
  int set_ups = 0;
  /// Share of the set-ups without their counterpart, the mounting of the same plate that is rotated by 180 degrees. An
  /// error that reverses its sign with this rotation affects S75 with this share. The interval includes the scatter of
  /// this error.
  double unpaired_share = 0;
  std::vector<double> dropped_contrasts_k{};
  /// Largest half-width at any contrast for the comparison with the twin, with `decide` and an equivalence margin.
  std::optional<double> equivalence_half_width_percent{};
  /// Bench time of the best design whose contrasts settle, if `best` has a settling band.
  std::optional<double> settled_s{};
  /// Bench time of the best design of a different kind, if `best` is an adaptive schedule.
  std::optional<double> not_adaptive_s{};
  /// The fastest ramp that meets the request; empty if the bench or the plan does not allow a ramp.
  std::optional<RampDesign> ramp{};
};

/// Returns the design with the least bench time that meets the request. Searches mountings of each plate, phases,
/// frames of each contrast, and whether the contrasts settle. The presentations are in the order of constant_stimuli():
/// fast changes run during slow changes, so no other nesting takes less time.
///
/// A design has at least three phases, eight presentations per contrast, and five set-ups, which the intervals of
/// graded answers require. If the plan has fewer than five set-ups, its number is the minimum. Mountings are added in
/// pairs of counterparts. The plate is located in fewer frames than planned if their noise is at most 0.15 % of the
/// highest contrast. With `decide` and without an equivalence margin, contrasts without a limit are left out, except
/// the highest contrast, which locates the plate.
///
/// A ramp between the strongest and the weakest contrast is compared. Its rate is the fastest that meets the request,
/// limited to the rate that the lag of the plate allows (0.1 s if the plan does not state the lag). The ramp takes 10
/// to 1200 s in one direction. The ramp is the best design if it is faster and the plan states the lag. An adaptive
/// schedule of the plan is compared in its own set-ups, at the widest half-width that meets the request. The plan as it
/// is remains the best design if it meets the request, no design is faster, and it has at least three phases and eight
/// presentations per contrast.
///
/// Errors: `invalid_input` (no design examined meets the request; the message states the least half-width, or the rows
/// of the budget that prevent the decision), predict_plan(), `interrupted`.
[[nodiscard]] Result<BestDesign> best_design(const Plan& plan, const ExperimentInputs& inputs,
                                             const DesignRequest& request, std::stop_token stop);

/// Returns the bench times and half-widths of the design and of the plan as it was.
[[nodiscard]] std::string times_in_words(const BestDesign& found);

/// Returns sentences about a design: its time, the parts of that time, and the effect of its set-ups.
[[nodiscard]] std::vector<std::string> in_words(const BestDesign& found);

}  // namespace todbench
