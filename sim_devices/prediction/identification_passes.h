// SPDX-License-Identifier: GPL-3.0-or-later
// Passes of the targets of an identification experiment: successive frames round a target that moves.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/identification_bank.h"
#include "sim_devices/prediction/identification.h"
#include "sim_devices/prediction/seen_window.h"
#include "sim_devices/prediction/window_noise.h"

namespace todbench {

/// Displacement of the target from frame to frame, in displayed samples.
[[nodiscard]] cv::Point2d step_of_pass(const SensorSpec& spec, SceneMotion motion);
/// Error: `invalid_input` in one sentence for a motion or a sequence of frames that the experiment does not simulate.
[[nodiscard]] Result<void> check_passes(const IdentificationTask& task);

/// Window round the target in one frame. `phase`: place of the target from the middle of the window, in samples.
struct PassWindow {
  cv::Mat1f kelvin;
  cv::Point2d phase;
};

/// Passes at one range. Thread-safe.
class IdentificationPasses {
 public:
  /// `spec` is the sensor of the range as planned; `shown` are the targets in displayed samples. `window` outlives the
  /// object, as does the task.
  IdentificationPasses(const IdentificationTask& task, const SensorSpec& spec, const SeenWindow& window,
                       double transmittance, std::vector<AlternativeAspects> shown, int side);

  /// The target of a view in every frame of a pass, without noise.
  struct Signals {
    std::vector<cv::Mat1f> frames;
    std::vector<cv::Point> corners;   ///< of each in the picture
    std::vector<cv::Point2d> places;  ///< of the target from the middle of the picture, in samples
  };
  [[nodiscard]] Signals signals(std::size_t target, std::size_t aspect, std::size_t phase) const;
  /// Windows that the observer of the task judges, with the noise of a draw: the first frame, all frames, or their mean
  /// at the place in the middle of the pass.
  [[nodiscard]] std::vector<PassWindow> windows(const Signals& signals, std::uint64_t draw) const;

 private:
  [[nodiscard]] cv::Rect window_at(cv::Point2d place) const;
  const IdentificationTask& task_;
  SensorSpec spec_;
  const SeenWindow& window_;
  double transmittance_;
  std::vector<AlternativeAspects> shown_;
  cv::Point2d step_;
  int frames_, side_, picture_;  ///< frames of a pass; sides of window and picture
  WindowNoise noise_;
};

/// Search that can be centred on any true place between two samples: half a sample further than that of the observer.
[[nodiscard]] TemplateObserverSpec searching_at_true_places(TemplateObserverSpec spec);
/// Adds `share` times the scores of such a search, centred on `phase`, to those of the observer's own search.
void add_centred(const TemplateObserverSpec& spec, std::span<const float> wide, cv::Point2d phase, float share,
                 std::span<float> own);
/// Number of templates of a view that the observer's own search compares.
[[nodiscard]] std::size_t places_of_search(const TemplateObserverSpec& spec);

}  // namespace todbench
