// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of an identification experiment for another observer.
#include <utility>

#include "acquisition/base/try.h"
#include "hvs/observer/identification_bank.h"
#include "sim_devices/prediction/identification.h"
#include "sim_devices/prediction/identification_passes.h"
#include "sim_devices/prediction/identification_views.h"
#include "sim_devices/prediction/seen_window.h"
#include "sim_devices/sensor/scene_image.h"

namespace todbench {

/// One range: everything except the observer.
struct IdentificationFrames::Range {
  Range(const IdentificationTask& experiment, const SeenTargets& targets, const IdentificationRange& range)
      : task(experiment),
        spec(sensor_at(task, range.range_m)),
        imager(spec, task.plan, task.accuracy, task.motion),
        window(spec, imager),
        transmittance(range.transmittance),
        alternatives(in_samples(targets, samples_per_metre(spec, range), spec, task.motion)) {}
  IdentificationTask task;
  SensorSpec spec;
  SceneImager imager;
  SeenWindow window;
  double transmittance;
  std::vector<AlternativeAspects> alternatives;
  std::unique_ptr<const IdentificationPasses> passes;
};

Result<IdentificationFrames> IdentificationFrames::of(const IdentificationTask& task) {
  TODBENCH_TRY_VOID(check_passes(task));
  if (task.sequence == SequenceObserver::tracking_sum)
    return fail(ErrorCode::invalid_input,
                "one picture cannot show the sum over a target that is tracked: use single-frame or static-sum");
  TODBENCH_TRY(const auto targets, seen_targets(task));
  IdentificationFrames frames;
  for (const auto& range : task.ranges) {
    auto at = std::make_shared<Range>(task, targets, range);
    const int side = identification_window_samples(task.observer, at->alternatives, at->spec.samples_per_pitch());
    TODBENCH_TRY(at->passes,
                 IdentificationPasses::of(at->task, at->spec, at->window, at->transmittance, at->alternatives, side));
    frames.ranges_.push_back(std::move(at));
  }
  for (const auto& target : targets) {
    auto& own = frames.contrasts_k_.emplace_back();
    for (const auto& aspect : target) own.push_back(aspect.dt_rss_k);
  }
  return frames;
}

Result<cv::Mat1f> IdentificationFrames::frame_k(std::size_t range, std::size_t target, std::size_t aspect,
                                                std::uint64_t draw) const {
  const IdentificationPasses& passes = *ranges_[range]->passes;
  std::size_t phase = 0;
  while (first_draw_of(phase, target, aspect) != draw % identification_phases) ++phase;
  TODBENCH_TRY(const auto windows, passes.windows(passes.signals(target, aspect, phase), draw));
  return windows.front().kelvin;
}

double IdentificationFrames::contrast_k(std::size_t range, std::size_t target, std::size_t aspect) const {
  return contrasts_k_[target][aspect] * ranges_[range]->transmittance;
}

}  // namespace todbench
