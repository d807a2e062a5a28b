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

/// Window round the target in one frame. `phase`: position of the target from the middle of the window, in samples.
struct PassWindow {
  cv::Mat1f kelvin;
  cv::Point2d phase;
};

/// Contrast and noise of a view after the stages, divided by the gain. Both are relative to the values before the
/// stages.
struct ViewScale {
  double contrast = 1, noise = 1;
};

/// Passes at one range. Thread-safe.
class IdentificationPasses {
 public:
  /// Prepares the passes. `spec` is the sensor of the range as planned; `shown` are the targets in displayed samples.
  /// `window` and the task must outlive the object. Errors: those of identify() about stages.
  [[nodiscard]] static Result<std::unique_ptr<const IdentificationPasses>> of(
      const IdentificationTask& task, const SensorSpec& spec, const SeenWindow& window, double transmittance,
      std::vector<AlternativeAspects> shown, int side);

  /// The target of a view in every frame of a pass, without noise.
  struct Signals {
    std::vector<cv::Mat1f> frames;    ///< including the frames before the pass that the stages store
    std::vector<cv::Point> corners;   ///< corner of each frame in the picture
    std::vector<cv::Point2d> places;  ///< position of the target from the middle of the picture, in samples
  };
  /// Returns the frames of a pass of this view and sampling phase.
  [[nodiscard]] Signals signals(std::size_t target, std::size_t aspect, std::size_t phase) const;
  /// Returns the windows that the observer of the task judges, with the noise of a draw. These are the first frame, all
  /// frames, or the mean of the frames at the position in the middle of the pass. In kelvin of the judged contrast.
  /// Errors: those of the stages.
  [[nodiscard]] Result<std::vector<PassWindow>> windows(const Signals& signals, std::uint64_t draw) const;

  /// Returns the scale of a view.
  [[nodiscard]] ViewScale scale(std::size_t target, std::size_t aspect) const { return scales_[target][aspect]; }
  /// Returns contrast and noise after the stages; empty without stages.
  [[nodiscard]] const std::optional<JudgedPictures>& judged() const { return judged_; }

 private:
  IdentificationPasses(const IdentificationTask& task, const SensorSpec& spec, const SeenWindow& window,
                       double transmittance, std::vector<AlternativeAspects> shown, int side);
  [[nodiscard]] Result<void> prepare_stages();
  [[nodiscard]] Result<void> measure_scales();
  /// Gain of the stages for a view, from a least-squares fit over the window: picture after the stages over picture
  /// before them.
  struct ViewGain {
    double product = 0, energy = 0;  ///< the gain is their ratio
    double variance = 0;             ///< variance of the product
    double noise_ratio = 1;
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
  int frames_, side_;            ///< frames of a pass; side of the window
  int lead_ = 0, surround_ = 0;  ///< frames, samples round the window, for the stages
  cv::Size picture_;
  std::optional<WindowNoise> noise_;
  std::vector<std::vector<ViewScale>> scales_;
  std::optional<JudgedPictures> judged_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<ChainStage>> without_memory_;  ///< kept from pass to pass
};

/// Returns the observer with a search that is half a sample wider. This search can be centred on any true position
/// between two samples.
[[nodiscard]] TemplateObserverSpec searching_at_true_places(TemplateObserverSpec spec);
/// Adds `share` times the scores `wide` to the scores `own`. `wide` comes from searching_at_true_places() and is
/// centred on `phase`; `own` comes from the observer's own search.
void add_centred(const TemplateObserverSpec& spec, std::span<const float> wide, cv::Point2d phase, float share,
                 std::span<float> own);
/// Returns the number of templates of a view that the observer's own search compares.
[[nodiscard]] std::size_t places_of_search(const TemplateObserverSpec& spec);

}  // namespace todbench
