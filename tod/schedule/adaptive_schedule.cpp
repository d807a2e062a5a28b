// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/adaptive_schedule.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

constexpr double least_trials = 40;
constexpr std::size_t least_sizes = 3;
constexpr double contradiction = 0.001;  // p of the deviance
constexpr double frame_s = 0.1;          // a presentation without any change: exposures after the change and the frame

/// Range of thresholds: from a third of the smallest size to three times the largest.
PsiOptions prior_over(const std::vector<TargetPlate>& plates, double distance_m, PsychometricForm form) {
  double smallest = plates.front().triangles.front().size_mm, largest = smallest;
  for (const TargetPlate& plate : plates) {
    for (const PlateTriangle& t : plate.triangles) {
      smallest = std::min(smallest, t.size_mm);
      largest = std::max(largest, t.size_mm);
    }
  }
  PsiOptions options;
  options.form = form;
  options.first_size = smallest / distance_m / 3;
  options.last_size = 3 * largest / distance_m;
  return options;
}

bool contradicted(const PsychometricFit& fit) {
  // The scatter of graded answers is a result of the fit, so that it cannot contradict it.
  if (fit.dispersion) return false;
  if (!fit.deviance || fit.degrees_of_freedom < 1 || *fit.deviance <= 0) return false;
  const distribution::ChiSquared law(fit.degrees_of_freedom);
  // Deviance over the clustered variance: trials of one presentation are not independent.
  return distribution::cdf(distribution::complement(law, *fit.deviance / fit.variance_inflation)) < contradiction;
}

/// Half the width of the 95 % interval of ln S75; empty while a side is open.
std::optional<double> half_width(const PsychometricFit& fit) {
  if (!fit.threshold || !fit.ci95.low || !fit.ci95.high || *fit.ci95.low <= 0) return std::nullopt;
  return std::log(*fit.ci95.high / *fit.ci95.low) / 2;
}

}  // namespace

double visit_seconds(const ConstantStimuliOptions& stimuli, bool other_plate, bool other_mounting, int contrasts) {
  const double* cost = stimuli.change_cost_s;
  return (other_plate ? cost[0] : 0) + (other_mounting ? cost[1] : 0) +
         contrasts * (cost[2] + stimuli.phases * (cost[3] + frame_s));
}

AdaptiveSchedule::AdaptiveSchedule(AdaptiveOptions options, const RandomStream& stream) : options_(std::move(options)) {
  assert(!options_.plates.empty() && options_.distance_m > 0 && options_.stimuli.phases > 0);
  for (std::size_t p = 0; p < options_.plates.size(); ++p) {
    std::vector<PhasedTriangle> triangles;
    for (std::size_t m = 0; m < options_.stimuli.mountings.size(); ++m) {
      if (!options_.stimuli.shows(p, m)) continue;
      const Mounting mounting = options_.stimuli.mountings[m];
      set_ups_.push_back({.plate = p, .mounting = mounting, .group = m});
      const auto more = phased_triangles(options_.plates[p], mounting, pixel_of(options_.stimuli), m);
      triangles.insert(triangles.end(), more.begin(), more.end());
    }
    if (options_.stimuli.mountings.empty()) continue;
    phases_.push_back(even_phases(triangles, options_.stimuli.mountings.size(), options_.stimuli.phases));
  }
  std::vector<double> sorted = options_.stimuli.delta_t_k;
  std::ranges::stable_sort(sorted, [](double a, double b) { return std::abs(a) > std::abs(b); });
  const PsiOptions prior = prior_over(options_.plates, options_.distance_m, options_.fit.form);
  for (std::size_t c = 0; c < sorted.size(); ++c) {
    Contrast contrast{.delta_t_k = sorted[c],
                      .knowledge = PsiPlacement(prior, stream.sub(2 * c)),
                      .trials = {},
                      .point = {},
                      .starts = {},
                      .progress = {}};
    contrast.progress.delta_t_k = sorted[c];
    const RandomStream start = stream.sub(2 * c + 1);
    for (std::size_t p = 0; p < options_.plates.size(); ++p)
      contrast.starts.emplace_back(start.uniform(2 * p), start.uniform(2 * p + 1));
    contrasts_.push_back(std::move(contrast));
  }
  if (!set_ups_.empty() && !contrasts_.empty()) begin_visit();
}

double AdaptiveSchedule::value_per_second(const SetUp& set_up) const {
  double gain = 0;
  int open = 0;
  for (const Contrast& contrast : contrasts_) {
    if (contrast.progress.settled) continue;
    ++open;
    if (contrast.progress.needs_set_up && &set_up == &set_ups_[current_set_up_]) continue;
    for (const PlateTriangle& t : options_.plates[set_up.plate].triangles)
      gain += contrast.knowledge.expected_gain(t.size_mm / options_.distance_m);
  }
  const SetUp& now = set_ups_[current_set_up_];
  const bool first = shown_ == 0;
  return gain /
         visit_seconds(options_.stimuli, !first && set_up.plate != now.plate, !first && set_up.mounting != now.mounting,
                       open) /
         (1 + set_up.visits);
}

void AdaptiveSchedule::begin_visit() {
  std::size_t best = 0;
  double best_value = -1;
  for (std::size_t s = 0; s < set_ups_.size(); ++s) {
    const double value = value_per_second(set_ups_[s]);
    if (value > best_value) {
      best_value = value;
      best = s;
    }
  }
  registered_ = shown_ > 0 && best == current_set_up_;
  current_set_up_ = best;
  ++set_ups_[best].visits;
  to_visit_.clear();
  for (std::size_t c = 0; c < contrasts_.size(); ++c) {
    // A new set-up needs one look at the highest contrast, settled or not.
    if (!contrasts_[c].progress.settled || (c == 0 && !registered_)) to_visit_.push_back(c);
  }
  shown_here_ = 0;
}

cv::Point2d AdaptiveSchedule::next_phase(const Contrast& contrast) const {
  const SetUp& set_up = set_ups_[current_set_up_];
  const EvenPhases& phases = phases_[set_up.plate];
  const cv::Point2d between = plastic_points(set_up.visits).back();
  const cv::Point2d p = phases.shifts[set_up.group][static_cast<std::size_t>(shown_here_)] +
                        contrast.starts[set_up.plate] + between.x * phases.cell[0] + between.y * phases.cell[1];
  return {p.x - std::floor(p.x), p.y - std::floor(p.y)};
}

std::optional<TargetState> AdaptiveSchedule::next() {
  if (set_ups_.empty() || contrasts_.empty()) return std::nullopt;
  const auto all_settled = [&] {
    return std::ranges::all_of(contrasts_, [](const Contrast& c) { return c.progress.settled; });
  };
  if (shown_ >= options_.max_presentations || all_settled()) return std::nullopt;
  const auto done_here = [&] {
    const bool settled = contrasts_[to_visit_.front()].progress.settled;
    return shown_here_ >= options_.stimuli.phases || (settled && (registered_ || shown_here_ > 0));
  };
  while (to_visit_.empty() || done_here()) {
    if (!to_visit_.empty()) to_visit_.erase(to_visit_.begin());
    shown_here_ = 0;
    if (to_visit_.empty()) begin_visit();
  }
  Contrast& contrast = contrasts_[to_visit_.front()];
  const SetUp& set_up = set_ups_[current_set_up_];
  TargetState state;
  state.plate = options_.plates[set_up.plate].name;
  state.mounting = set_up.mounting;
  state.delta_t_k = contrast.delta_t_k;
  state.shift_mm = shift_of(next_phase(contrast), options_.stimuli);
  registered_ = true;
  ++contrast.progress.presentations;
  ++shown_here_;
  ++shown_;
  return state;
}

void AdaptiveSchedule::observe_contrasts(const std::map<double, ContrastError>& errors) {
  contrast_errors_ = errors;
}

void AdaptiveSchedule::observe(std::span<const Trial> trials) {
  std::map<std::pair<double, double>, std::pair<double, double>> counts;  // contrast, size: right, all
  for (const Trial& trial : trials) {
    auto& count = counts[{trial.set_delta_t_k, trial.size_mrad}];
    count.first += trial.correct() ? 1 : 0;
    count.second += 1;
  }
  for (Contrast& contrast : contrasts_) {
    bool changed = false;
    for (const auto& [key, count] : counts) {
      if (key.first != contrast.delta_t_k) continue;
      contrast.knowledge.observe(key.second, count.first, count.second);
      changed = true;
    }
    if (!changed) continue;
    for (const Trial& trial : trials) {
      if (trial.set_delta_t_k == contrast.delta_t_k) contrast.trials.push_back(trial);
    }
    judge(contrast);
  }
}

std::optional<TodPoint> AdaptiveSchedule::fitted(const Contrast& contrast) const {
  FitOptions options = options_.fit;
  options.with_posterior = false;
  auto curve = tod_curve(contrast.trials, options);
  if (!curve || curve->points.empty()) return std::nullopt;
  TodPoint point = std::move(curve->points.front());
  point.levels.clear();
  if (const auto function = options_.functions.find(contrast.delta_t_k); function != options_.functions.end()) {
    if (auto shaped = fit_twin_shape(graded_answers(contrast.trials), point.fit, function->second, options))
      point.fit = *std::move(shaped);
  }
  if (!half_width(point.fit)) return std::nullopt;
  return point;
}

bool AdaptiveSchedule::narrow_enough(Contrast& contrast) const {
  const double asked = options_.half_width_percent / 100, of_answers = *half_width(contrast.point->fit);
  double joined = of_answers;
  if (options_.with_contrast_errors) {
    TodCurve curve;
    std::size_t own = 0;
    for (const Contrast& other : contrasts_) {
      if (&other == &contrast) own = curve.points.size();
      if (other.point) curve.points.push_back(*other.point);
    }
    set_contrast_errors(curve, contrast_errors_);
    join_contrast_errors(curve);
    joined = half_width(curve.points[own].fit).value_or(of_answers);
  }
  contrast.progress.half_width_percent = 100 * joined;
  contrast.progress.needs_set_up =
      joined >= asked && of_answers * of_answers < (1 - contrast_decides) * joined * joined;
  if (joined < asked) return true;
  const bool out_of_reach = joined * joined - of_answers * of_answers >= asked * asked;
  return out_of_reach && std::ranges::all_of(set_ups_, [](const SetUp& one) { return one.visits > 1; });
}

void AdaptiveSchedule::judge(Contrast& contrast) const {
  ContrastProgress& progress = contrast.progress;
  progress.trials = static_cast<double>(contrast.trials.size());
  progress.half_width_percent.reset();
  progress.settled = progress.needs_set_up = false;
  contrast.point = fitted(contrast);
  if (!contrast.point) return;
  const bool narrow = narrow_enough(contrast);
  std::vector<double> sizes;
  for (const Trial& trial : contrast.trials) sizes.push_back(trial.size_mrad);
  std::ranges::sort(sizes);
  const auto distinct = static_cast<std::size_t>(std::unique(sizes.begin(), sizes.end()) - sizes.begin());
  const PsychometricFit& fit = contrast.point->fit;
  progress.settled = narrow && fit.verdict == FitVerdict::ok && progress.trials >= least_trials &&
                     distinct >= least_sizes && progress.presentations >= least_adaptive_presentations &&
                     !contradicted(fit);
}

std::vector<ContrastProgress> AdaptiveSchedule::progress() const {
  std::vector<ContrastProgress> out;
  for (const Contrast& contrast : contrasts_) out.push_back(contrast.progress);
  return out;
}

}  // namespace todbench
