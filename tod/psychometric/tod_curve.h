// SPDX-License-Identifier: GPL-3.0-or-later
// TOD curve: thresholds as a function of contrast.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tod/presentation/trial.h"
#include "tod/psychometric/finding.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Reason for the kind of answers: graded or binary.
enum class AnswersReason {
  plan,               ///< stated by the plan
  twin,               ///< graded answers: the model observer judges, and the function of the twin is fitted
  weibull,            ///< a Weibull function is fitted; the error of its form exceeds the interval of graded answers
  lapse,              ///< the plan has a lapse, but graded answers come from an observer without a lapse
  adaptive,           ///< only in sessions of earlier versions: the schedule is adaptive
  grey_levels,        ///< intervals of graded answers are not validated for contrasts in grey levels
  few_presentations,  ///< too few presentations to estimate the scatter of graded answers
  no_function,        ///< graded answers were recorded, but the twin had no function for the fit
  person,             ///< a person answered
  package,            ///< an enhancement package, evaluated with a Weibull function
  moving_target,      ///< a moving target, evaluated with a Weibull function
};
inline constexpr std::array all_answers_reasons{
    AnswersReason::plan,     AnswersReason::twin,        AnswersReason::weibull,           AnswersReason::lapse,
    AnswersReason::adaptive, AnswersReason::grey_levels, AnswersReason::few_presentations, AnswersReason::no_function,
    AnswersReason::person,   AnswersReason::package,     AnswersReason::moving_target};
[[nodiscard]] std::string_view to_string(AnswersReason reason);
/// Returns the reason as a part of a sentence, for example "the plan names them".
[[nodiscard]] std::string_view in_words(AnswersReason reason);

/// Answers from which a threshold was fitted.
struct AnswersTaken {
  AnswerKind kind = AnswerKind::binary;
  int frames = 1;  ///< frames of a presentation over which graded answers are averaged
  AnswersReason reason = AnswersReason::plan;
  bool operator==(const AnswersTaken&) const = default;
};

/// Answers to the triangles of one direction.
struct DirectionAnswers {
  int trials = 0;
  double correct = 0;  ///< sum of the probabilities, or number of correct answers
  double percent = 0;  ///< (threshold / threshold of all directions - 1) in percent, to first order
};

/// Thresholds by the direction of the triangles in the picture (tod/adequacy/orientation.h).
struct Orientations {
  std::array<DirectionAnswers, all_apexes.size()> directions{};  ///< in the order of all_apexes
  double axes_percent = 0;     ///< (threshold of up and down / threshold of left and right - 1) in percent
  double axes_se_percent = 0;  ///< standard error, from the scatter over plates and mountings
  int set_ups = 0;             ///< number of plates and mountings
  double p = 1;                ///< probability that chance causes a larger difference
};

/// One contrast of a TOD curve.
struct TodPoint {
  double set_delta_t_k = 0;  ///< set contrast, by which the points of two curves are matched
  double delta_t_k = 0;      ///< effective contrast measured by the camera (mean over trials)
  /// Standard error of delta_t_k by contrast_error(), from the measurements (one per set-up and set-point) and their
  /// triangles. If no triangles are recorded, it is computed from the measurements alone. In this case it is 0 for a
  /// single measurement, because the scatter is not known (contrast_se_k()).
  double delta_t_se_k = 0;
  double delta_t_shared_se_k = 0;  ///< part of delta_t_se_k that the scatter over measurements does not contain
  int delta_t_measurements = 0;    ///< number of measurements; 0: not stated
  std::optional<double> delta_t_freedom{};  ///< degrees of freedom of delta_t_se_k; empty: measurements minus one
  std::vector<Level> levels;                ///< data of the fit: one element per size and cluster
  PsychometricFit fit;                      ///< fit with sizes in mrad
  /// Reason for a Weibull function or for the function of the twin; empty: not stated.
  std::optional<EstimatorReason> estimator_reason;
  std::optional<AnswersTaken> answers;            ///< empty: not stated
  std::optional<PsychometricFit> free_lapse_fit;  ///< fit of the same answers with a free lapse, as a check
  bool lapse_warning = false;        ///< the free lapse describes the data significantly better (2 ln LR > 2.71)
  std::optional<Adequacy> adequacy;  ///< findings against the threshold; empty: not examined
  /// S75 from the direct estimate, without an assumed psychometric form; only for simulated sensors.
  std::optional<double> direct_s75_mrad;
  std::optional<double> direct_s75_se_mrad;
  /// S75 over the range of the observer's open parameters, low and high. This is not a confidence interval. Empty: the
  /// observer has no open parameters, or they were not varied.
  std::optional<std::pair<double, double>> s75_spread_mrad;
  /// Share of the point's trials with saturated pixels inside the window of their triangle.
  double saturated_share = 0;
  /// Temporal noise of a pixel in counts; empty: not known, or the values are not integer counts.
  std::optional<double> noise_counts;
  std::optional<double> lag1_correlation;      ///< correlation of a pixel's noise between successive frames
  std::optional<Orientations> orientations{};  ///< empty: not compared
};

/// One contrast of a continuous curve.
struct ContinuousPoint {
  double delta_t_k = 0;
  double s75_mrad = 0;
  Interval ci95;
};

/// A measured or simulated TOD curve. Acuity is 1 / S75.
struct TodCurve {
  std::string observer, sensor;
  std::vector<TodPoint> points;               ///< contrast decreasing
  std::vector<ContinuousPoint> continuous{};  ///< curve of a ramp, contrast decreasing; empty: the run had no ramp
};

/// Smallest gain in twice the ln likelihood with which a free lapse causes a warning. The value corresponds to 5 % for
/// a parameter that is at its bound under the null hypothesis.
inline constexpr double boundary_drop = 2.705543454095404;

/// Groups trials by set contrast, counts them per size and presentation, and fits each group. Intervals are computed
/// once with clusters by presentation and once with clusters by position on the plate, because answers at one position
/// have the same fixed pattern. The wider interval is reported. If all answers of a group are graded, fit_graded() fits
/// them with one variance for both. Errors: `invalid_input` (no trials, a non-finite contrast), those of the fit.
[[nodiscard]] Result<TodCurve> tod_curve(std::span<const Trial> trials, const FitOptions& options);

/// Converts trials to binary answers. Each answer is that to one frame.
[[nodiscard]] std::vector<Trial> as_binary(std::span<const Trial> trials);

/// Returns the answers with their presentations and places. For binary answers the probabilities are 1 and 0.
[[nodiscard]] std::vector<GradedAnswer> graded_answers(std::span<const Trial> trials);

/// Returns whether two set contrasts are regarded as equal, because they differ by at most 0.5 % of the larger
/// contrast.
[[nodiscard]] bool same_contrast(double a_k, double b_k);

/// Returns the point of a curve with this set contrast; the nearest point if there are several; null if there is none.
[[nodiscard]] const TodPoint* point_at(const TodCurve& curve, double set_delta_t_k);

}  // namespace todbench
