// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the frames that may be measured. A selected frame was accepted by the integrity gate, was exposed after the
// last change of the scene, and was not exposed during a correction.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "acquisition/core/correction_watch.h"
#include "acquisition/core/frame_source.h"
#include "acquisition/core/integrity_gate.h"
#include "acquisition/core/repeat_cadence.h"
#include "tod/measurement/lag_differences.h"

namespace todbench {

/// A rejected frame, with the reason.
struct RejectedFrame {
  std::uint64_t sequence = 0;
  Rejection reason = Rejection::incomplete;
  std::optional<CorrectionSign> seen{};  ///< evidence of a correction in the picture; empty: none
};

/// Options of FrameTaker.
struct FrameTakerOptions {
  IntegrityOptions integrity;
  /// Number of exposures discarded after a change of the scene, because they may show the scene before the change.
  int frames_after_change = 2;
  double nuc_wait_s = 1;                          ///< frames within this time after a correction are rejected
  double max_rejected_share = 0.05;               ///< a larger share, after 100 frames, is an `integrity` error
  std::chrono::milliseconds frame_timeout{2000};  ///< longest time without a frame; then `disconnected`
  std::function<void(const RejectedFrame&)> on_rejected{};  ///< called for every rejected frame; may be empty
  /// Gain of the camera's frames. It determines how noise is computed from differences of frames.
  FrameGain gain = FrameGain::constant;
  std::shared_ptr<const RadiometricScale> scale{};  ///< replaces the scale of every frame; null: the scale of each
                                                    ///< frame is used
};

/// Average of accepted frames in kelvin, with the noise computed from the differences of the frames.
struct AveragedPicture {
  cv::Mat1d kelvin;
  cv::Mat1w lowest, highest;  ///< smallest and largest count of each pixel over the frames
  int significant_bits = 16;
  /// Standard deviation per pixel and frame: sqrt(mean d^2 / 2), where d is the difference of a pixel between
  /// successive frames, without changes of the whole frame. 0 for a single frame.
  double temporal_noise_k = 0;
  /// Lag-1 correlation of a pixel's noise in successive frames (first_order_correlation()); empty: fewer than eight
  /// frames, or no noise.
  std::optional<double> lag1_correlation;
  /// Unbiased variances per frame of row noise and column noise that change from frame to frame. May be negative by
  /// chance. Empty for a single frame.
  std::optional<double> row_variance_k2, column_variance_k2;
  /// Largest integer that divides all differences between frames. It is above 1 if a format does not use the lowest
  /// bits, or if a camera rounds to steps of several counts. 0: all frames are equal.
  int count_step = 0;
};

/// Returns the noise of a pixel in one frame, in kelvin. If the lag-1 correlation rho is at least 0.05, it is
/// temporal_noise_k / sqrt(1 - rho), because differences of successive frames contain only the part sqrt(1 - rho) of
/// the noise. Otherwise it is temporal_noise_k.
[[nodiscard]] double noise_of_one_frame(const AveragedPicture& picture);

/// Takes frames from a started source. One thread at a time.
class FrameTaker {
 public:
  FrameTaker(FrameSource& source, FrameTakerOptions options);

  /// Announces a change of the scene. Frames that arrived before `now_ns` (clock of Frame::host_time_ns) are discarded.
  void scene_changed(std::int64_t now_ns);
  /// Commands a non-uniformity correction of the camera. Errors: those of FrameSource::correct_nonuniformity().
  [[nodiscard]] Result<void> correct_nonuniformity();
  /// Announces that the commanded correction is complete. Frames are rejected until nuc_wait_s after `now_ns`.
  void corrected(std::int64_t now_ns);

  /// Returns the next accepted frame. Errors: `integrity` (too many rejected), `disconnected` (lost, or no frame within
  /// the frame timeout), `interrupted`.
  [[nodiscard]] Result<Frame> next(std::stop_token stop);
  /// Takes and judges frames while the target changes, until `enough` returns true. `enough` is called before each
  /// request to the source, with the number of previous requests. The scene may move. It is not an error if the source
  /// sends no frames. Other errors: those of next().
  [[nodiscard]] Result<void> take_while_presenting(const std::function<bool(std::int64_t calls)>& enough);
  /// Returns the next accepted frame of a moving scene. Discards no frame, and does not treat a changing picture as a
  /// correction. Errors: those of next().
  [[nodiscard]] Result<Frame> next_of_moving_scene(std::stop_token stop);
  /// Removes one accepted frame from the source without counting it as used. Errors: those of next().
  [[nodiscard]] Result<void> discard(std::stop_token stop);
  /// Function that is called with each frame of an average and its picture in kelvin.
  using EachFrame = std::function<void(const Frame&, const cv::Mat1d& kelvin)>;
  /// Averages `count` accepted frames. `each`: called for each frame; may be empty. Errors: next(), to_kelvin().
  [[nodiscard]] Result<AveragedPicture> average(int count, std::stop_token stop, const EachFrame& each = {});

  [[nodiscard]] std::uint64_t used() const { return used_; }
  [[nodiscard]] std::uint64_t lost() const { return gate_.lost(); }
  [[nodiscard]] const NumberingFaults& numbering() const { return gate_.numbering(); }
  [[nodiscard]] std::map<std::string, std::uint64_t> rejected() const;
  /// Returns a sentence if the camera sends each exposure several times; otherwise empty.
  [[nodiscard]] std::string cadence() const { return cadence_.sentence(); }
  /// Returns whether the camera reports corrections. True if the camera stated for at least one frame whether it was
  /// exposed during a correction.
  [[nodiscard]] bool camera_tells_of_corrections() const { return told_of_corrections_; }
  /// Returns the seconds between the last correction (commanded, reported by the camera, or detected in the picture)
  /// and a frame; negative if no correction is known.
  [[nodiscard]] double since_nuc_s(const Frame& frame) const;

 private:
  enum class Scene { still, moving };
  [[nodiscard]] Result<Frame> from_source(const std::stop_token& stop);
  [[nodiscard]] Result<void> check_share() const;
  /// Applies the integrity gate, then the checks for corrections.
  [[nodiscard]] std::optional<RejectedFrame> judge(const Frame& frame, Scene scene);
  /// Applies judge(), counts the frame and calls on_rejected. Returns whether the frame is accepted, or the error that
  /// ends the run.
  [[nodiscard]] Result<bool> accept(const Frame& frame, Scene scene);
  void note_told_correction(const Frame& frame);
  [[nodiscard]] std::optional<CorrectionSign> see_correction(const Frame& frame, std::optional<Rejection> rejection,
                                                             Scene scene);

  FrameSource& source_;
  FrameTakerOptions options_;
  IntegrityGate gate_;
  RepeatCadence cadence_;
  CorrectionWatch watch_{CorrectionWatchOptions{}};
  std::int64_t valid_from_ns_ = 0;            ///< host time of the last change of scene
  int to_discard_ = 0;                        ///< number of exposures still to be discarded after the change
  std::optional<std::int64_t> nuc_ns_;        ///< host time of the last correction
  std::optional<std::int64_t> known_nuc_ns_;  ///< host time of the last correction that was commanded or reported
  std::uint64_t used_ = 0;
  std::uint64_t seen_ = 0;
  std::uint64_t excused_ = 0;  ///< rejections that are not counted, because the scene moves
  bool told_of_corrections_ = false;
};

/// Returns a window of a frame in kelvin. Error: `calibration` if a pixel has no temperature.
[[nodiscard]] Result<cv::Mat1d> window_kelvin(const Frame& frame, const cv::Rect& window);

}  // namespace todbench
