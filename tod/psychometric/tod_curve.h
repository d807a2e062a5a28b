// Thresholds over contrast.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tod/presentation/trial.h"
#include "tod/psychometric/finding.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Why answers were graded, or right and wrong.
enum class AnswersReason {
  plan,               ///< the plan names them
  twin,               ///< graded: the model observer judges, and the function of the twin is fitted
  weibull,            ///< a Weibull function is off by more than the interval of graded answers
  lapse,              ///< the plan has a lapse; graded answers are those of an observer without
  adaptive,           ///< in sessions of earlier versions: the schedule is adaptive
  grey_levels,        ///< intervals of graded answers are not proven where contrasts are those of grey levels
  few_presentations,  ///< too few to tell how graded answers scatter
  no_function,        ///< graded ones were taken, and there was no function of the twin to fit them with
  person,             ///< a person answered
  package,            ///< behind a package of enhancement, with a Weibull function
  moving_target,      ///< likewise of a target that moves
};
inline constexpr std::array all_answers_reasons{
    AnswersReason::plan,     AnswersReason::twin,        AnswersReason::weibull,           AnswersReason::lapse,
    AnswersReason::adaptive, AnswersReason::grey_levels, AnswersReason::few_presentations, AnswersReason::no_function,
    AnswersReason::person,   AnswersReason::package,     AnswersReason::moving_target};
[[nodiscard]] std::string_view to_string(AnswersReason reason);
/// In a sentence: "the plan names them".
[[nodiscard]] std::string_view in_words(AnswersReason reason);

/// The answers that a threshold rests on.
struct AnswersTaken {
  AnswerKind kind = AnswerKind::binary;
  int frames = 1;  ///< of a presentation, over which graded answers are averaged
  AnswersReason reason = AnswersReason::plan;
  bool operator==(const AnswersTaken&) const = default;
};

/// One contrast of a TOD curve.
struct TodPoint {
  double set_delta_t_k = 0;  ///< what the target was told: the name by which points are paired
  double delta_t_k = 0;      ///< effective contrast measured by the camera (mean over trials)
  /// Standard error of that mean: over the measurements of it (one per set-up and set-point) and the triangles each was
  /// made by, contrast_error(); over the measurements alone where nothing is said of triangles; 0 of a single one then,
  /// whose scatter nobody knows: contrast_se_k().
  double delta_t_se_k = 0;
  double delta_t_shared_se_k = 0;           ///< part of it that no scatter over the measurements shows
  int delta_t_measurements = 0;             ///< how many those are; 0: not said
  std::optional<double> delta_t_freedom{};  ///< degrees of freedom of that error; nothing: measurements less one
  std::vector<Level> levels;                ///< counts per size, one row per size and cluster: what the fit saw
  PsychometricFit fit;                      ///< in mrad
  /// Why the fit is with a Weibull function or with that of the twin; nothing: not said.
  std::optional<EstimatorReason> estimator_reason;
  std::optional<AnswersTaken> answers;            ///< nothing: not said
  std::optional<PsychometricFit> free_lapse_fit;  ///< the same with a free lapse, as a check
  bool lapse_warning = false;             ///< the free lapse explains the data significantly better (2 ln LR > 2.71)
  std::optional<Adequacy> adequacy;       ///< what speaks against the threshold; nothing: not examined
  std::optional<double> direct_s75_mrad;  ///< simulated sensors only: no psychometric form assumed
  std::optional<double> direct_s75_se_mrad;
  double saturated_share =
      0;  ///< of the point's trials: those with saturated pixels inside the window of their triangle
  std::optional<double>
      noise_counts;  ///< temporal noise of a pixel in counts; nothing: not known or not counted in whole numbers
  std::optional<double> lag1_correlation;  ///< of a pixel's noise between successive frames
};

/// A measured or simulated TOD curve. Acuity is 1 / S75.
struct TodCurve {
  std::string observer, sensor;
  std::vector<TodPoint> points;  ///< contrast decreasing
};

/// Twice the ln likelihood by which a free lapse has to be better for a warning: 5 % where the parameter is at its
/// bound under the null hypothesis.
inline constexpr double boundary_drop = 2.705543454095404;

/// Groups trials by set contrast, counts them per size and presentation, and fits each group. Intervals are clustered
/// by presentation and by place on the plate (which shares fixed pattern); the wider one is reported. A group all of
/// whose answers are graded is fitted by fit_graded(), with both clusterings in one variance.
[[nodiscard]] Result<TodCurve> tod_curve(std::span<const Trial> trials, const FitOptions& options);

/// The same trials as right and wrong answers to one frame each.
[[nodiscard]] std::vector<Trial> as_binary(std::span<const Trial> trials);

/// Answers with their presentations and places; right and wrong ones as probabilities of 1 and 0.
[[nodiscard]] std::vector<GradedAnswer> graded_answers(std::span<const Trial> trials);

/// Whether two set contrasts are the same one: equal to 0.5 % of the larger.
[[nodiscard]] bool same_contrast(double a_k, double b_k);

/// The point of a curve with this set contrast, the nearest of several; null where there is none.
[[nodiscard]] const TodPoint* point_at(const TodCurve& curve, double set_delta_t_k);

}  // namespace todbench
