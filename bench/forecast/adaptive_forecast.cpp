// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/adaptive_forecast.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>

#include "acquisition/base/rng.h"
#include "bench/forecast/contrast_forecast.h"
#include "bench/forecast/interval_prediction.h"
#include "bench/forecast/visit_order.h"
#include "bench/plan/plan_options.h"
#include "tod/schedule/adaptive_schedule.h"

namespace todbench {
namespace {

constexpr std::size_t simulated = 64;  // runs: the mean time has a standard error of about 3 %

/// A contrast of the plan, for all runs.
struct PlannedContrast {
  ContrastPrediction constant;            ///< prediction of constant stimuli
  std::optional<AnswerForecast> answers;  ///< empty: no threshold is expected, so the schedule goes on to its cap
  double slope = 0;                       ///< of ln S75 over ln contrast; 0: the contrast is no part of the interval
  std::vector<std::vector<TriangleNoise>> noise{};             ///< contrast_noise()
  std::map<std::vector<int>, ContrastPrediction> predicted{};  ///< by the presentations of each set-up
};

/// A contrast in one run.
struct ContrastCourse {
  RandomStream stream;
  std::vector<int> shown{};  ///< presentations in each set-up
  std::vector<int> looks{};  ///< measurements of the contrast in each set-up
  int presentations = 0;
  std::vector<double> deviations{};  ///< sum of the drawn deviations in each set-up, in standard deviations
  double squares = 0;                ///< sum of squared deviations of the presentations
  double contrast_half_width = 0;    ///< of ln S75, due to the measured contrast
  bool settled = false;
  bool stopped = false;       ///< settled because its interval is narrow enough
  bool needs_set_up = false;  ///< as in ContrastProgress
};

struct Course {
  std::vector<ContrastCourse> contrasts;
  AdaptiveRun visits{};
  int presentations = 0;
};

/// Draws the deviations of the next presentation. The mean of a set-up changes with every presentation.
void draw_presentation(ContrastCourse& course, std::size_t set_up) {
  const RandomStream stream = course.stream.sub(1);
  course.squares += std::pow(stream.normal(static_cast<std::uint64_t>(course.presentations)), 2);
  course.deviations[set_up] += stream.sub(set_up).normal(static_cast<std::uint64_t>(course.shown[set_up]));
  ++course.shown[set_up];
  ++course.presentations;
}

/// Ratio of the estimated to the expected standard error over set-ups.
double ratio_over_set_ups(const ContrastCourse& course) {
  double count = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < course.shown.size(); ++i) {
    if (course.shown[i] == 0) continue;
    const double z = course.deviations[i] / std::sqrt(course.shown[i]);
    count += 1;
    sum += z;
    squares += z * z;
  }
  return std::sqrt(std::max(0.0, squares - sum * sum / count) / (count - 1));
}

/// The same over presentations. The largest of three variances is used (clustered_variance.h), which scatters less than
/// each of them: 0.43 / sqrt(presentations) in eight runs of a plan of 2 % with 10 to 25 presentations.
double ratio_over_presentations(const ContrastCourse& course) {
  constexpr double of_largest = 0.61;  // 0.43 over the 1 / sqrt(2 presentations) of chi-square
  return std::sqrt(1 + of_largest * (course.squares / course.presentations - 1));
}

double error_ratio(const ContrastCourse& course, const ContrastPrediction& expected, AnswerKind answers) {
  if (answers == AnswerKind::binary) return std::exp(scatter_of_binary_error * course.stream.sub(1).normal(0));
  return expected.over_set_ups ? ratio_over_set_ups(course) : ratio_over_presentations(course);
}

class Simulation {
 public:
  Simulation(const Plan& plan, const ExperimentInputs& inputs, std::vector<PlannedContrast> contrasts)
      : plan_(plan),
        inputs_(inputs),
        contrasts_(std::move(contrasts)),
        set_ups_(numbered_set_ups(plan, inputs.plates.size())),
        answers_(chosen_answers(plan, inputs.sensor).kind) {
    for (std::size_t c = 0; c < contrasts_.size(); ++c) highest_first_.push_back(c);
    std::ranges::stable_sort(highest_first_, std::greater<>(),
                             [&](std::size_t c) { return std::abs(contrasts_[c].constant.delta_t_k); });
  }

  /// Goes through the visits of the schedule until every contrast is settled, or until the cap.
  [[nodiscard]] Course run(std::uint64_t number) {
    Course course;
    const RandomStream stream = RandomStream(1, "adaptive_forecast").sub(number);
    for (std::size_t c = 0; c < contrasts_.size(); ++c)
      course.contrasts.push_back({.stream = stream.sub(c),
                                  .shown = std::vector<int>(set_ups_.size()),
                                  .looks = std::vector<int>(set_ups_.size()),
                                  .deviations = std::vector<double>(set_ups_.size())});
    VisitOrder order(plan_, set_ups_);
    while (course.presentations < plan_.schedule.max_presentations) {
      const auto open = std::ranges::count(course.contrasts, false, &ContrastCourse::settled);
      if (open == 0) break;
      const auto useful_here = std::ranges::count_if(
          course.contrasts, [](const ContrastCourse& one) { return !one.settled && !one.needs_set_up; });
      visit(course, order.next(static_cast<int>(open), static_cast<int>(useful_here)), order.visits());
    }
    return course;
  }

  /// Prediction of a contrast after these presentations of each set-up. Precondition: a threshold is expected.
  [[nodiscard]] const ContrastPrediction& predicted(std::size_t c, const std::vector<int>& shown) {
    PlannedContrast& contrast = contrasts_[c];
    const auto [found, is_new] = contrast.predicted.try_emplace(shown, contrast.constant);
    if (is_new) predict_interval(found->second, plan_, inputs_, *contrast.answers, shown);
    return found->second;
  }

  [[nodiscard]] const std::vector<PlannedContrast>& contrasts() const { return contrasts_; }

 private:
  void visit(Course& course, std::size_t set_up, const std::vector<int>& visits) {
    const int phases = plan_.camera.id.empty() ? plan_.simulation.phases : plan_.target.phases;
    const bool new_set_up = course.visits.empty() || course.visits.back().set_up != set_up;
    course.visits.push_back({.set_up = set_up, .presentations = std::vector<int>(contrasts_.size())});
    for (const std::size_t c : highest_first_) {
      ContrastCourse& contrast = course.contrasts[c];
      if (contrast.settled) continue;
      if (new_set_up) look(contrast, contrasts_[c], set_up);
      int& shown = course.visits.back().presentations[c];
      while (shown < phases && !contrast.settled && course.presentations < plan_.schedule.max_presentations) {
        ++shown;
        draw_presentation(contrast, set_up);
        ++course.presentations;
        judge(contrast, c, visits);
      }
    }
  }

  void look(ContrastCourse& contrast, const PlannedContrast& planned, std::size_t set_up) const {
    ++contrast.looks[set_up];
    if (!(planned.slope > 0)) return;
    contrast.contrast_half_width = simulated_contrast_half_width(
        planned.noise, contrast.looks, planned.constant.delta_t_k, planned.slope, contrast.stream.sub(0));
  }

  /// The end of AdaptiveSchedule: narrow enough, or two visits of each set-up if the contrast alone exceeds the target.
  void judge(ContrastCourse& contrast, std::size_t c, const std::vector<int>& visits) {
    if (!contrasts_[c].answers) return;
    const ContrastPrediction& expected = predicted(c, contrast.shown);
    const double of_answers = expected.interval_factor * expected.se_ln_s75 * error_ratio(contrast, expected, answers_);
    const double joined = std::hypot(of_answers, contrast.contrast_half_width);
    const double asked = plan_.schedule.half_width_percent / 100;
    contrast.needs_set_up = joined >= asked && of_answers * of_answers < (1 - contrast_decides) * joined * joined;
    if (contrast.presentations < least_adaptive_presentations) return;
    contrast.stopped = joined < asked;
    contrast.settled = contrast.stopped || (contrast.contrast_half_width >= asked &&
                                            std::ranges::all_of(visits, [](int number) { return number > 1; }));
  }

  const Plan& plan_;
  const ExperimentInputs& inputs_;
  std::vector<PlannedContrast> contrasts_;
  std::vector<NumberedSetUp> set_ups_;
  std::vector<std::size_t> highest_first_;
  AnswerKind answers_;
};

std::vector<PlannedContrast> planned_contrasts(const std::vector<ContrastPrediction>& constant, const Plan& plan,
                                               const ExperimentInputs& inputs) {
  const std::vector<double> slopes =
      plan.camera.id.empty() ? std::vector<double>(constant.size()) : expected_contrast_effects(constant);
  std::vector<PlannedContrast> contrasts;
  for (std::size_t i = 0; i < constant.size(); ++i) {
    contrasts.push_back({.constant = constant[i],
                         .answers = std::nullopt,
                         .slope = slopes[i],
                         .noise = contrast_noise(plan, inputs, constant[i].delta_t_k)});
    if (constant[i].uncertainty_percent)
      contrasts.back().answers = answer_forecast(plan, inputs, constant[i].delta_t_k);
  }
  return contrasts;
}

/// The run with the median number of presentations.
const Course& median_of(const std::vector<Course>& courses) {
  std::vector<const Course*> sorted;
  for (const Course& course : courses) sorted.push_back(&course);
  std::ranges::stable_sort(sorted, {}, &Course::presentations);
  return *sorted[sorted.size() / 2];
}

}  // namespace

AdaptiveForecast adaptive_forecast(const std::vector<ContrastPrediction>& constant, const Plan& plan,
                                   const ExperimentInputs& inputs) {
  Simulation simulation(plan, inputs, planned_contrasts(constant, plan, inputs));
  std::vector<Course> courses;
  for (std::size_t run = 0; run < simulated; ++run) courses.push_back(simulation.run(run));
  const Course& median = median_of(courses);
  const double per_presentation = triangles_of(inputs.plates) / static_cast<double>(inputs.plates.size());
  AdaptiveForecast out;
  for (std::size_t c = 0; c < constant.size(); ++c) {
    const ContrastCourse& course = median.contrasts[c];
    const bool identified = simulation.contrasts()[c].answers && course.presentations > 0;
    ContrastPrediction point = identified ? simulation.predicted(c, course.shown) : constant[c];
    int stopped = 0;
    double presentations = 0;
    for (const Course& one : courses) {
      presentations += one.contrasts[c].presentations;
      stopped += one.contrasts[c].stopped ? 1 : 0;
    }
    point.trials = std::round(presentations / simulated * per_presentation);
    if (2 * stopped >= static_cast<int>(simulated))
      point.uncertainty_percent = point.stopped_at_percent = 100 * std::expm1(plan.schedule.half_width_percent / 100);
    out.contrasts.push_back(point);
    out.looks.push_back(course.looks);
  }
  for (Course& course : courses) out.runs.push_back(std::move(course.visits));
  return out;
}

}  // namespace todbench
