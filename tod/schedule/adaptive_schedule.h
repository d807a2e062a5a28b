// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses presentations according to the uncertainty that remains after the previous answers.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tod/psychometric/contrast_slope.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/psychometric/tod_curve.h"
#include "tod/schedule/even_phases.h"
#include "tod/schedule/psi_placement.h"
#include "tod/schedule/schedule.h"

namespace todbench {

/// Minimum number of presentations at a contrast before it can be settled.
inline constexpr int least_adaptive_presentations = 8;

/// Returns the duration of a visit to a set-up, in s. The duration consists of the times for changes of plate, mounting
/// and contrasts, the times for shifts, and 0.1 s for each presentation.
[[nodiscard]] double visit_seconds(const ConstantStimuliOptions& stimuli, bool other_plate, bool other_mounting,
                                   int contrasts);

/// Options of AdaptiveSchedule.
struct AdaptiveOptions {
  /// Plates, mountings, contrasts, pixel size and costs of changes. `phases`: number of presentations of a contrast in
  /// a visit to a set-up.
  ConstantStimuliOptions stimuli;
  std::vector<TargetPlate> plates;  ///< plates in identity mounting, with the sizes on each plate
  double distance_m = 0;
  FitOptions fit;  ///< options of the final fit
  /// Functions of the twin by contrast, if the final fit uses them. A contrast without an entry uses a Weibull
  /// function.
  std::map<double, ProportionTable> functions{};
  double half_width_percent = 10;     ///< target for the half-width of the 95 % interval of ln S75, at every contrast
  bool with_contrast_errors = false;  ///< true: the interval includes the errors of the measured contrasts
                                      ///< (observe_contrasts())
  /// Largest number of presentations over all contrasts. At least one visit is made for each contrast.
  int max_presentations = 1000;
};

/// Progress at a contrast.
struct ContrastProgress {
  double delta_t_k = 0;
  double trials = 0;
  int presentations = 0;
  /// Half-width of the interval; empty while a side of the interval is open.
  std::optional<double> half_width_percent;
  bool settled = false;
  /// True if the contrast is not settled and at least three quarters of the variance are due to the measured contrast.
  /// This variance is reduced by presentations in a different set-up, but not by presentations in the same set-up.
  bool needs_set_up = false;
};

/// Share of the variance due to the measured contrast, above which the measured contrast determines the width of the
/// interval.
inline constexpr double contrast_decides = 0.75;

/// Adaptive choice of set-ups (plate and mounting). A presentation gives answers to all its triangles, and only changes
/// of the target cost time. The schedule therefore visits the set-up with the largest expected reduction of entropy per
/// second of target changes. The entropy is that of the thresholds of the contrasts that are not settled
/// (PsiPlacement::expected_gain(), summed over triangles). Set-ups that were visited before have less weight, to vary
/// the positions on the plate. A visit begins at the highest contrast, at which the plate is registered. The contrasts
/// that are not settled follow. A contrast is settled when three conditions are met, also during a visit: there are at
/// least 40 trials of three sizes in eight presentations; the interval is two-sided and its half-width is below the
/// target; the data do not contradict the fit (deviance, p > 0.001). Graded answers have no deviance, and the interval
/// is computed from the scatter of the answers. If the interval includes the errors of the measured contrasts, and
/// these errors alone exceed the target, the contrast is settled after two visits of each set-up. The run ends when all
/// contrasts are settled, or at max_presentations. The shifts of a visit are those of even_phases() over the mountings
/// of the plate. On each further visit to a set-up, the shifts are between those of earlier visits.
class AdaptiveSchedule final : public TrialSchedule {
 public:
  AdaptiveSchedule(AdaptiveOptions options, const RandomStream& stream);

  [[nodiscard]] std::optional<TargetState> next() override;
  [[nodiscard]] std::size_t planned() const override { return static_cast<std::size_t>(options_.max_presentations); }
  void observe(std::span<const Trial> trials) override;
  void observe_contrasts(const std::map<double, ContrastError>& errors) override;

  /// Returns the progress at the contrasts, highest first.
  [[nodiscard]] std::vector<ContrastProgress> progress() const;

 private:
  struct SetUp {
    std::size_t plate = 0;
    Mounting mounting = Mounting::identity;
    std::size_t group = 0;  ///< index of the mounting
    int visits = 0;
  };
  struct Contrast {
    double delta_t_k = 0;
    PsiPlacement knowledge;
    std::vector<Trial> trials;
    std::optional<TodPoint> point{};  ///< last fit, without the errors of contrasts
    std::vector<cv::Point2d> starts;  ///< starts of the phases of each plate, fractions of a pixel
    ContrastProgress progress;
  };

  void begin_visit();
  /// Returns the phase of the next presentation of a contrast in this set-up, as a fraction of a pixel.
  [[nodiscard]] cv::Point2d next_phase(const Contrast& contrast) const;
  [[nodiscard]] double value_per_second(const SetUp& set_up) const;
  void judge(Contrast& contrast) const;
  /// Fits the answers at a contrast; empty if the fit fails.
  [[nodiscard]] std::optional<TodPoint> fitted(const Contrast& contrast) const;
  /// Sets the half-width at a contrast. Returns whether the half-width is below the target, or cannot be reduced to the
  /// target.
  [[nodiscard]] bool narrow_enough(Contrast& contrast) const;

  AdaptiveOptions options_;
  std::vector<SetUp> set_ups_;
  std::vector<EvenPhases> phases_;  ///< phases of each plate
  std::vector<Contrast> contrasts_;
  std::map<double, ContrastError> contrast_errors_;
  std::size_t current_set_up_ = 0;
  std::vector<std::size_t> to_visit_;  ///< remaining contrasts of this visit, the present contrast first
  int shown_here_ = 0;                 ///< presentations of the present contrast in this visit
  bool registered_ = false;            ///< true: the visit has shown its first contrast
  int shown_ = 0;
};

}  // namespace todbench
