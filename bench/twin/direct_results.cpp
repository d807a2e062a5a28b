// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/direct_results.h"

#include <cmath>
#include <utility>

#include "bench/twin/twin_shapes.h"
#include "hvs/observer/open_parameters.h"
#include "hvs/observer/template_observer.h"

namespace todbench {
namespace {

/// Adds the spread over the open parameters. A contrast without a threshold at an end has no spread and a note.
void add_spread(const ExperimentInputs& inputs, DirectEstimateOptions options, DirectResults& results) {
  options.accuracy.standard_error_percent = 0;  // the spread is ten times wider than the error of the usual draws
  const auto ends =
      at_open_ends(inputs.observer, [&](const TemplateObserverSpec& spec) -> Result<std::map<double, double>> {
        TemplateObserver observer(spec, triangle_alternatives());
        std::map<double, double> sizes_pitch;
        for (const auto& [contrast, point] : results.points) {
          const auto found = direct_estimate(inputs.sensor, inputs.effects, observer, {contrast}, options);
          if (found) {
            sizes_pitch[contrast] = found->front().s75_pitch;
          } else if (found.error().code == ErrorCode::interrupted) {
            return tl::unexpected(found.error());
          } else {
            results.notes.push_back("no spread over the observer's open parameters: " + found.error().message);
          }
        }
        return sizes_pitch;
      });
  if (!ends) results.ended_by = ends.error();
  if (!ends || !*ends) return;
  for (const auto& [contrast, best] : (**ends)[0]) {
    const auto worst = (**ends)[1].find(contrast);
    if (worst != (**ends)[1].end()) results.spread_pitch[contrast] = *spread_of({best, worst->second});
  }
}

}  // namespace

DirectResults direct_results(const TodCurve& curve, const ExperimentInputs& inputs,
                             const std::map<double, double>& shown_delta_t_k, std::uint64_t seed,
                             std::stop_token stop) {
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  const DirectEstimateOptions options = direct_options(curve, inputs, shown_delta_t_k, seed, std::move(stop));
  std::vector<double> contrasts;
  for (const auto& point : curve.points) contrasts.push_back(point.delta_t_k);
  DirectResults results;
  // Contrasts estimated together share their images. If one has no threshold, the others are estimated alone.
  std::vector<std::vector<double>> attempts{contrasts};
  for (std::size_t i = 0; i < attempts.size() && !results.ended_by; ++i) {
    auto found = direct_estimate(inputs.sensor, inputs.effects, observer, attempts[i], options);
    if (found) {
      for (std::size_t k = 0; k < found->size(); ++k) results.points[attempts[i][k]] = (*found)[k];
    } else if (found.error().code == ErrorCode::interrupted) {
      results.ended_by = found.error();
    } else if (attempts[i].size() > 1) {
      for (const double contrast : contrasts) attempts.push_back({contrast});
    } else {
      results.notes.push_back("no direct estimate: " + found.error().message);
    }
  }
  if (!results.ended_by) add_spread(inputs, options, results);
  return results;
}

void keep_direct(const DirectResults& direct, double pitch_mrad, TodCurve& curve) {
  for (auto& point : curve.points) {
    const auto found = direct.points.find(point.delta_t_k);
    if (found == direct.points.end()) continue;
    point.direct_s75_mrad = found->second.s75_pitch * pitch_mrad;
    point.direct_s75_se_mrad = found->second.standard_error_pitch * pitch_mrad;
    const auto spread = direct.spread_pitch.find(point.delta_t_k);
    if (spread == direct.spread_pitch.end()) continue;
    point.s75_spread_mrad = {spread->second.first * pitch_mrad, spread->second.second * pitch_mrad};
  }
}

Result<void> refine_thresholds(ExperimentInputs& inputs, std::uint64_t seed, std::stop_token stop) {
  constexpr double standard_error_percent = 0.4;
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  for (ContrastOutlook& outlook : inputs.outlooks) {
    DirectEstimateOptions options{.motion = inputs.motion, .accuracy = inputs.accuracy, .seed = seed, .stop = stop};
    options.accuracy.standard_error_percent = standard_error_percent;
    auto found = direct_estimate(inputs.sensor, inputs.effects, observer, {std::abs(outlook.delta_t_k)}, options);
    if (!found && found.error().code != ErrorCode::interrupted) {
      options.accuracy.standard_error_percent = 0;
      found = direct_estimate(inputs.sensor, inputs.effects, observer, {std::abs(outlook.delta_t_k)}, options);
    }
    if (found) {
      outlook.s75_pitch = found->front().s75_pitch;
    } else if (found.error().code == ErrorCode::interrupted) {
      return tl::unexpected(found.error());
    }
  }
  return {};
}

}  // namespace todbench
