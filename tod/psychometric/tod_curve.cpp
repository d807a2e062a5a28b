// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/tod_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/psychometric/picture_places.h"
#include "tod/psychometric/psychometric_clusters.h"

namespace todbench {
namespace {

using TrialGroup = std::vector<const Trial*>;

// Trials of one presentation share frame, phase and set-up.
std::int64_t presentation_of(const Trial& trial) {
  return trial.presentation;
}

// Trials of one place share its detectors, hence their fixed pattern.
using Place = std::tuple<std::string, Mounting, std::string>;
Place place_of(const Trial& trial) {
  return {trial.plate, trial.mounting, trial.triangle};
}

// Whether a group is graded: all of its answers are.
bool graded(const TrialGroup& trials) {
  return std::ranges::all_of(trials, [](const Trial* t) { return t->probability_correct.has_value(); });
}

// One row per size and cluster.
template <typename Key>
std::vector<Level> count(const TrialGroup& trials, Key (*key_of)(const Trial&)) {
  const bool by_probability = graded(trials);
  std::map<Key, int> numbers;
  std::map<std::pair<double, int>, Level> rows;
  for (const Trial* trial : trials) {
    const int number = numbers.emplace(key_of(*trial), static_cast<int>(numbers.size())).first->second;
    Level& row = rows[{trial->size_mrad, number}];
    row.size = trial->size_mrad;
    row.cluster = number;
    row.total += 1;
    row.correct += by_probability ? *trial->probability_correct : (trial->correct() ? 1 : 0);
  }
  std::vector<Level> levels;
  for (const auto& [key, row] : rows) levels.push_back(row);
  return levels;
}

struct Candidate {
  std::vector<Level> levels;
  PsychometricFit fit;

  // Required drop of the likelihood for a 95 % limit: inflation times the square of Student's t.
  [[nodiscard]] double drop() const { return confidence_drop({fit.clusters, fit.variance_inflation}, 0.95); }
};

Result<Candidate> candidate(std::vector<Level> levels, const FitOptions& options) {
  TODBENCH_TRY(auto fit, fit_psychometric(levels, options));
  return Candidate{std::move(levels), fit};
}

// The clustering that widens the intervals more. A single cluster has no variance, so it is chosen only if both have
// one.
Result<Candidate> widest(const TrialGroup& trials, FitOptions options) {
  options.with_posterior = false;
  auto by_presentation = candidate(count<std::int64_t>(trials, presentation_of), options);
  if (!by_presentation) return by_presentation;
  auto by_place = candidate(count<Place>(trials, place_of), options);
  if (!by_place) return by_place;
  if (by_place->fit.clusters < 2) return by_presentation;
  if (by_presentation->fit.clusters < 2) return by_place;
  return by_place->drop() > by_presentation->drop() ? by_place : by_presentation;
}

// Effective contrast: mean over trials, standard error over its measurements. The camera measures a contrast once per
// set-up and set-point; all presentations until the next change carry the same value.
void add_contrast(TodPoint& point, const TrialGroup& trials) {
  std::set<std::tuple<std::string, Mounting, double>> measurements;
  double sum = 0;
  for (const Trial* trial : trials) {
    sum += trial->delta_t_k;
    measurements.emplace(trial->plate, trial->mounting, trial->delta_t_k);
  }
  point.delta_t_k = sum / static_cast<double>(trials.size());
  point.delta_t_measurements = static_cast<int>(measurements.size());
  const auto n = static_cast<double>(measurements.size());
  if (n < 2) return;
  double mean = 0, square = 0;
  for (const auto& measurement : measurements) mean += std::get<double>(measurement) / n;
  for (const auto& measurement : measurements) square += std::pow(std::get<double>(measurement) - mean, 2);
  point.delta_t_se_k = std::sqrt(square / (n - 1) / n);
}

// Fits the answers of a group as graded or as right and wrong ones.
class Fitter {
 public:
  explicit Fitter(const TrialGroup& trials) : trials_(trials), graded_(graded(trials)) {
    if (!graded_) return;
    std::vector<Trial> copies;
    for (const Trial* trial : trials) copies.push_back(*trial);
    answers_ = graded_answers(copies);
  }

  // Sets the levels for the fits.
  Result<void> choose_levels(TodPoint& point, const FitOptions& options) const {
    if (graded_) {
      point.levels = count<std::int64_t>(trials_, presentation_of);
      return {};
    }
    TODBENCH_TRY(auto chosen, widest(trials_, options));
    point.levels = std::move(chosen.levels);
    return {};
  }

  [[nodiscard]] Result<PsychometricFit> fit(const TodPoint& point, const FitOptions& options) const {
    return graded_ ? fit_graded(answers_, options) : fit_psychometric(point.levels, options);
  }

 private:
  const TrialGroup& trials_;
  bool graded_;
  std::vector<GradedAnswer> answers_;
};

Result<TodPoint> tod_point(double set_delta_t_k, const TrialGroup& trials, const FitOptions& options) {
  TodPoint point;
  point.set_delta_t_k = set_delta_t_k;
  add_contrast(point, trials);
  const auto saturated = std::ranges::count_if(trials, [](const Trial* t) { return t->saturated_pixels > 0; });
  point.saturated_share = static_cast<double>(saturated) / static_cast<double>(trials.size());
  const Fitter fitter(trials);
  TODBENCH_TRY_VOID(fitter.choose_levels(point, options));
  TODBENCH_TRY(point.fit, fitter.fit(point, options));
  if (!options.fixed_lapse) return point;
  FitOptions free = options;
  free.fixed_lapse.reset();
  free.with_posterior = false;
  TODBENCH_TRY(auto free_fit, fitter.fit(point, free));
  point.free_lapse_fit = free_fit;
  if (point.fit.log_likelihood && free_fit.log_likelihood) {
    const double scale = is_quasi(point.fit.interval) ? point.fit.variance_inflation : 1;
    point.lapse_warning = 2 * (*free_fit.log_likelihood - *point.fit.log_likelihood) > scale * boundary_drop;
  }
  return point;
}

}  // namespace

std::string_view to_string(AnswersReason reason) {
  switch (reason) {
    case AnswersReason::plan:
      return "plan";
    case AnswersReason::twin:
      return "twin";
    case AnswersReason::weibull:
      return "weibull";
    case AnswersReason::lapse:
      return "lapse";
    case AnswersReason::adaptive:
      return "adaptive";
    case AnswersReason::grey_levels:
      return "grey-levels";
    case AnswersReason::few_presentations:
      return "few-presentations";
    case AnswersReason::no_function:
      return "no-function";
    case AnswersReason::person:
      return "person";
    case AnswersReason::package:
      return "package";
    case AnswersReason::moving_target:
      return "moving-target";
  }
  return "unknown";
}

std::string_view in_words(AnswersReason reason) {
  switch (reason) {
    case AnswersReason::plan:
      return "the plan names them";
    case AnswersReason::twin:
      return "the model observer answers and the function of the twin is fitted";
    case AnswersReason::weibull:
      return "the error of a Weibull function exceeds the interval of graded answers";
    case AnswersReason::lapse:
      return "the plan states a lapse rate";
    case AnswersReason::adaptive:
      return "the schedule is adaptive";
    case AnswersReason::grey_levels:
      return "the contrast is measured in grey levels";
    case AnswersReason::few_presentations:
      return "there are too few presentations to estimate the scatter of graded answers";
    case AnswersReason::no_function:
      return "there is no function of the twin for a fit of graded answers";
    case AnswersReason::person:
      return "a person answered";
    case AnswersReason::package:
      return "a Weibull function is fitted behind a package";
    case AnswersReason::moving_target:
      return "a Weibull function is fitted for a moving target";
  }
  return "unknown";
}

std::vector<Trial> as_binary(std::span<const Trial> trials) {
  std::vector<Trial> out(trials.begin(), trials.end());
  for (Trial& trial : out) {
    trial.probability_correct.reset();
    trial.frames = 1;
  }
  return out;
}

std::vector<GradedAnswer> graded_answers(std::span<const Trial> trials) {
  std::map<std::int64_t, int> presentations;
  std::map<std::pair<std::string, Mounting>, int> set_ups;
  std::vector<GradedAnswer> answers;
  const auto number = [](auto& numbers, const auto& key) {
    return numbers.emplace(key, static_cast<int>(numbers.size())).first->second;
  };
  const std::vector<int> places = picture_places(trials);
  for (const Trial& trial : trials) {
    answers.push_back({.size = trial.size_mrad,
                       .probability_correct = trial.probability_correct.value_or(trial.correct() ? 1 : 0),
                       .presentation = number(presentations, trial.presentation),
                       .place = places[answers.size()],
                       .set_up = number(set_ups, std::pair(trial.plate, trial.mounting))});
  }
  return answers;
}

Result<TodCurve> tod_curve(std::span<const Trial> trials, const FitOptions& options) {
  if (trials.empty()) return fail(ErrorCode::invalid_input, "TOD curve: no trials");
  const auto strongest_first = [](double a, double b) { return std::pair(std::abs(a), a) > std::pair(std::abs(b), b); };
  std::map<double, TrialGroup, decltype(strongest_first)> groups(strongest_first);
  for (const Trial& trial : trials) {
    if (!std::isfinite(trial.set_delta_t_k))
      return fail(ErrorCode::invalid_input, "TOD curve: a contrast is not finite");
    groups[trial.set_delta_t_k].push_back(&trial);
  }
  TodCurve curve;
  for (const auto& [contrast, group] : groups) {
    auto point = tod_point(contrast, group, options);
    if (!point) return fail(fmt::format("fitting contrast {:.6g} K", contrast), point.error());
    curve.points.push_back(std::move(*point));
  }
  return curve;
}

bool same_contrast(double a_k, double b_k) {
  constexpr double tolerance = 0.005;
  return std::abs(a_k - b_k) <= tolerance * std::max(std::abs(a_k), std::abs(b_k));
}

const TodPoint* point_at(const TodCurve& curve, double set_delta_t_k) {
  const auto distance = [&](const TodPoint& point) { return std::abs(point.set_delta_t_k - set_delta_t_k); };
  const TodPoint* best = nullptr;
  for (const TodPoint& point : curve.points) {
    if (!same_contrast(point.set_delta_t_k, set_delta_t_k)) continue;
    if (best == nullptr || distance(point) <= distance(*best)) best = &point;
  }
  return best;
}

}  // namespace todbench
