// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/fit_words.h"

#include <algorithm>
#include <vector>

#include "bench/report/number_format.h"

namespace todbench {
namespace {

std::vector<const TodPoint*> points_by(const ReportData& data, FitEstimator estimator) {
  std::vector<const TodPoint*> points;
  for (const std::optional<TodCurve>* curve : {&data.measured, &data.simulated}) {
    if (!*curve) continue;
    for (const TodPoint& point : (*curve)->points)
      if (estimator_of(point.fit) == estimator) points.push_back(&point);
  }
  return points;
}

/// Returns the reason in brackets; empty if unknown.
std::string reason_of(const TodPoint& point) {
  return point.estimator_reason ? " (" + std::string(in_words(*point.estimator_reason)) + ")" : std::string();
}

std::string twin_in_words(const ReportData& data, const std::vector<const TodPoint*>& points) {
  std::string text = "The psychometric function is that of the simulated twin" + reason_of(*points.front()) +
                     ", averaged over phases and noise without a parametric form. It is fitted to the answers by "
                     "quasi-likelihood, shifted and, if needed, stretched in ln S. S₇₅ is the size at which it crosses "
                     "0.75. The slope b is that of the Weibull function with the same slope at S₇₅.";
  const std::vector<const TodPoint*> others = points_by(data, FitEstimator::weibull);
  for (std::size_t i = 0; i < others.size(); ++i) {
    const bool simulated = data.measured && data.simulated && others[i] >= data.simulated->points.data() &&
                           others[i] < data.simulated->points.data() + data.simulated->points.size();
    text += std::string(i == 0 ? " Contrasts with a Weibull function instead: " : ", ") +
            stated(others[i]->set_delta_t_k) + " K" + (simulated ? ", simulated" : "") + reason_of(*others[i]) +
            (i + 1 == others.size() ? "." : "");
  }
  return text;
}

std::string frames_in_words(int frames) {
  return std::to_string(frames) + (frames == 1 ? " frame" : " frames");
}

/// Describes the answers of contrasts that share kind and reason; names the contrasts if `contrasts`.
std::string answers_in_words(const std::vector<const TodPoint*>& points, bool contrasts) {
  const AnswersTaken& first = *points.front()->answers;
  const bool graded = first.kind == AnswerKind::graded;
  const bool alike = std::ranges::all_of(
      points, [&](const TodPoint* point) { return !graded || point->answers->frames == first.frames; });
  const std::string reason = " (" + std::string(in_words(first.reason)) + ")";
  std::string text = graded ? "graded: the observer's probability of a correct answer" + reason + ", averaged over "
                            : "right or wrong, one answer for each frame" + reason;
  if (graded && alike) text += frames_in_words(first.frames) + " of a presentation";
  for (std::size_t i = 0; (contrasts || !alike) && i < points.size(); ++i) {
    if (i > 0) text += ", ";
    if (!alike) text += frames_in_words(points[i]->answers->frames) + (i == 0 ? " of a presentation" : "");
    text += (alike && i > 0 ? "" : " at ") + stated(points[i]->set_delta_t_k) + " K";
  }
  return text;
}

std::string answers_in_words(const TodCurve& curve) {
  std::vector<std::vector<const TodPoint*>> alike;
  for (const TodPoint& point : curve.points) {
    if (!point.answers) continue;
    const auto group = std::ranges::find_if(alike, [&](const std::vector<const TodPoint*>& points) {
      const AnswersTaken& first = *points.front()->answers;
      return first.kind == point.answers->kind && first.reason == point.answers->reason;
    });
    if (group == alike.end())
      alike.push_back({&point});
    else
      group->push_back(&point);
  }
  std::string text;
  for (const auto& points : alike) text += (text.empty() ? "" : "; ") + answers_in_words(points, alike.size() > 1);
  return text;
}

}  // namespace

std::string form_in_words(const ReportData& data) {
  if (const auto points = points_by(data, FitEstimator::twin_shape); !points.empty())
    return twin_in_words(data, points);
  const std::string form = data.fit.form == PsychometricForm::size
                               ? "ψ(S) = 0.25 + (0.75 − λ)(1 − exp(−(S/a)^b)), a Weibull function of size"
                               : "ψ(S) = 0.25 + (0.75 − λ) exp(−(a/S)^b), a Weibull function of acuity 1/S";
  const std::string lapse =
      data.fit.fixed_lapse ? "lapse λ fixed at " + stated(*data.fit.fixed_lapse) : "lapse λ free between 0 and 0.1";
  const auto points = points_by(data, FitEstimator::weibull);
  return form + (points.empty() ? std::string() : reason_of(*points.front())) + ", " + lapse +
         ", fitted by maximum likelihood. S₇₅ is the size at which ψ = 0.75.";
}

std::string answers_in_words(const ReportData& data) {
  const std::string measured = data.measured ? answers_in_words(*data.measured) : std::string();
  const std::string simulated = data.simulated ? answers_in_words(*data.simulated) : std::string();
  if (measured.empty() || simulated.empty() || measured == simulated) {
    const std::string& only = measured.empty() ? simulated : measured;
    return only.empty() ? only : " Answers are " + only + ".";
  }
  return " Answers are " + measured + ". The answers of the twin are " + simulated + ".";
}

}  // namespace todbench
