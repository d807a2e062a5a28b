// SPDX-License-Identifier: GPL-3.0-or-later
// Passes of the targets of an identification experiment: successive frames round a moving target, after the stages.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/identification_bank.h"
#include "sim_devices/prediction/identification.h"
#include "sim_devices/prediction/seen_window.h"
#include "sim_devices/prediction/window_noise.h"

namespace todbench {

/// Returns the picture without its mean.
[[nodiscard]] cv::Mat1d without_mean(const cv::Mat& picture);

/// Returns the displacement of the target from frame to frame, in displayed samples.
[[nodiscard]] cv::Point2d step_of_pass(const SensorSpec& spec, SceneMotion motion);
/// Fails with `invalid_input` for a motion or a sequence of frames that the experiment does not simulate.
[[nodiscard]] Result<void> check_passes(const IdentificationTask& task);

/// Window round the target in a frame, in kelvin. `phase`: target minus middle of the window, in samples.
struct PassWindow {
  cv::Mat1f kelvin;
  cv::Point2d phase;
};

/// Contrast and noise of a view in the judged pictures, relative to the values before the stages. Judged pictures are
/// divided by the gain of all views.
struct ViewScale {
  double contrast = 1, noise = 1;
};

/// Passes at one range. Thread-safe.
class IdentificationPasses {
 public:
  /// Prepares the passes. `spec`: sensor of the range as planned; `shown`: targets in displayed samples; `side`: side
  /// of the window in samples. `window` and the task must outlive the object. Errors: those of identify() about stages.
  [[nodiscard]] static Result<std::unique_ptr<const IdentificationPasses>> of(
      const IdentificationTask& task, const SensorSpec& spec, const SeenWindow& window, double transmittance,
      std::vector<AlternativeAspects> shown, int side);

  /// The target of a view in every frame of a pass, without noise.
  struct Signals {
    std::vector<cv::Mat1f> frames;    ///< with the frames before the pass that the stages store
    std::vector<cv::Point> corners;   ///< corner of each frame in the picture
    std::vector<cv::Point2d> places;  ///< position of the target from the middle of the picture, in samples
  };
  /// Returns the frames of a pass of this view and sampling phase.
  [[nodiscard]] Signals signals(std::size_t target, std::size_t aspect, std::size_t phase) const;
  /// Returns the windows that the observer of the task judges, with the noise of draw `draw`: the first frame, all
  /// frames, or the mean of the frames at the position in the middle of the pass. In kelvin, divided by the gain of the
  /// stages. Errors: those of the stages.
  [[nodiscard]] Result<std::vector<PassWindow>> windows(const Signals& signals, std::uint64_t draw) const;

  /// Returns contrast and noise of a view after the stages.
  [[nodiscard]] ViewScale scale(std::size_t target, std::size_t aspect) const { return scales_[target][aspect]; }
  /// Returns contrast and noise after the stages; empty without stages.
  [[nodiscard]] const std::optional<JudgedPictures>& judged() const { return judged_; }

 private:
  IdentificationPasses(const IdentificationTask& task, const SensorSpec& spec, const SeenWindow& window,
                       double transmittance, std::vector<AlternativeAspects> shown, int side);
  [[nodiscard]] Result<void> prepare_stages();
  [[nodiscard]] Result<void> measure_scales();
  /// Gain of the stages for a view: the least-squares factor from the picture before the stages to the picture after
  /// the stages, over the window.
  struct ViewGain {
    double product = 0, energy = 0;  ///< the gain is product / energy
    double variance = 0;             ///< variance of the product
    double noise_ratio = 1;          ///< noise after the stages over noise before the stages
    [[nodiscard]] double gain() const { return product / energy; }
  };
  /// `empty`: judged frames without a target and with the same noise.
  [[nodiscard]] Result<ViewGain> gain_of(std::size_t target, std::size_t aspect, const std::vector<cv::Mat1f>& noise,
                                         const std::vector<cv::Mat1f>& empty) const;
  /// Returns the window whose middle is the sample nearest to `place`.
  [[nodiscard]] cv::Rect window_at(cv::Point2d place) const;
  /// Adds the targets to the noise, sends the frames through the stages, and returns the frames of the pass.
  [[nodiscard]] Result<std::vector<cv::Mat1f>> shown_frames(std::vector<cv::Mat1f> noise, const Signals& signals) const;
  [[nodiscard]] Result<void> through_stages(std::vector<cv::Mat1f>& frames) const;

  const IdentificationTask& task_;
  SensorSpec spec_;
  const SeenWindow& window_;
  double transmittance_;
  std::vector<AlternativeAspects> shown_;
  cv::Point2d step_;
  int frames_, side_;            ///< number of frames of a pass; side of the window in samples
  int lead_ = 0, surround_ = 0;  ///< frames before the pass, and samples round the window, that the stages need
  cv::Size picture_;
  std::optional<WindowNoise> noise_;
  std::vector<std::vector<ViewScale>> scales_;
  std::optional<JudgedPictures> judged_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<ChainStage>> without_memory_;  ///< stages without memory, kept from pass to pass
};

/// Returns the observer with a search range that is half a sample larger on every side. This range can be centred on
/// any true position between two samples.
[[nodiscard]] TemplateObserverSpec searching_at_true_places(TemplateObserverSpec spec);
/// Adds `share` x `wide`, centred on `phase` (in samples), to `own`. `wide`: scores of the observer
/// searching_at_true_places(); `own`: scores of the observer `spec` with its own search.
void add_centred(const TemplateObserverSpec& spec, std::span<const float> wide, cv::Point2d phase, float share,
                 std::span<float> own);
/// Returns the number of search positions of the observer's own search, each with one template of a view.
[[nodiscard]] std::size_t places_of_search(const TemplateObserverSpec& spec);

}  // namespace todbench
