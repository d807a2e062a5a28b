// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/package_spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "bench/enhance/enhancement.h"
#include "bench/judgement/verdict.h"
#include "hvs/observer/open_parameters.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Returns the number of trials of a presentation at the end of the list.
std::size_t answered_of(const std::vector<Trial>& trials, std::int64_t presentation) {
  const auto other = std::find_if(trials.rbegin(), trials.rend(),
                                  [&](const Trial& trial) { return trial.presentation != presentation; });
  return static_cast<std::size_t>(other - trials.rbegin());
}

std::optional<double> s75_at(const TodCurve& curve, double set_delta_t_k) {
  const TodPoint* point = point_at(curve, set_delta_t_k);
  return point != nullptr && threshold_identified(point->fit) ? point->fit.threshold : std::nullopt;
}

bool has_spread(const PackageResult& result, double set_delta_t_k) {
  const TodPoint* point = point_at(result.curve, set_delta_t_k);
  return point != nullptr && point->s75_spread_mrad;
}

}  // namespace

OpenEnds::OpenEnds(const TemplateObserverSpec& observer) {
  for (const TemplateObserverSpec& end : open_ends(observer))
    ends_.push_back(std::make_unique<TemplateObserver>(end, triangle_alternatives()));
}

void OpenEnds::judge(const Trial& trial, const Patch& patch, const MeasurementOptions& options, EndTrials& into) {
  const int finer = options.judged_samples_per_pixel;
  for (std::size_t end = 0; end < ends_.size() && !into.failure; ++end) {
    const auto prepared = ends_[end]->prepare(trial.size_px * finer, options.samples_per_pitch * finer);
    if (!prepared) {
      into.failure = prepared.error();
      return;
    }
    std::vector<Trial>& trials = into.trials[end];
    const std::size_t triangle = answered_of(trials, trial.presentation);
    const Choice choice =
        (*prepared)->choose(patch, trial.delta_t_k, answer_noise(options.seed, trial.presentation, triangle));
    trials.push_back(trial);
    trials.back().answer = static_cast<Apex>(choice.alternative);
    std::copy_n(choice.scores.begin(), trials.back().scores.size(), trials.back().scores.begin());
  }
}

std::vector<std::string> add_spreads(const FitOptions& options, const PackageResult* none, PackageResult& result) {
  constexpr const char* names[] = {"best", "worst"};
  if (result.at_ends.failure)
    return {result.name + ": no spread over the open parameters of the observer: " + result.at_ends.failure->message};
  const auto& [best, worst] = result.at_ends.trials;
  if (best.empty()) return {};
  std::vector<std::string> sentences;
  std::array<TodCurve, 2> curves;
  for (std::size_t end = 0; end < curves.size(); ++end)
    curves[end] = tod_curve(result.at_ends.trials[end], options).value_or(TodCurve{});
  for (TodPoint& point : result.curve.points) {
    if (!threshold_identified(point.fit)) continue;
    const auto of_best = s75_at(curves[0], point.set_delta_t_k), of_worst = s75_at(curves[1], point.set_delta_t_k);
    point.s75_spread_mrad = spread_of({of_best, point.fit.threshold, of_worst});
    if (point.s75_spread_mrad) continue;
    sentences.push_back(fmt::format(
        "{} at {:g} K: no spread over the open parameters of the observer: the {} observer of their range has no "
        "threshold at the sizes of the plate",
        result.name, point.set_delta_t_k, names[of_best ? 1 : 0]));
  }
  if (none == nullptr) return sentences;
  const auto of_best = paired_ratios(best, none->at_ends.trials[0], options),
             of_worst = paired_ratios(worst, none->at_ends.trials[1], options);
  for (std::size_t i = 0; i < result.ratios.size() && i < of_best.size() && i < of_worst.size(); ++i) {
    const double contrast = result.ratios[i].set_delta_t_k;
    if (has_spread(result, contrast) && has_spread(*none, contrast))
      result.ratios[i].spread = spread_of({of_best[i].ratio, result.ratios[i].ratio, of_worst[i].ratio});
  }
  return sentences;
}

bool any_spread(const Enhancement& enhancement) {
  return std::ranges::any_of(enhancement.results, [](const PackageResult& result) {
    return std::ranges::any_of(result.curve.points, [](const TodPoint& point) { return !!point.s75_spread_mrad; }) ||
           std::ranges::any_of(result.ratios, [](const PairedRatio& ratio) { return !!ratio.spread; });
  });
}

}  // namespace todbench
