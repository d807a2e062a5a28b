// SPDX-License-Identifier: GPL-3.0-or-later
// Selects frames fit for measurement: past the integrity gate, exposed after the last change, not during a correction.
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
  std::optional<CorrectionSign> seen{};  ///< sign of a correction in the picture, if the picture showed it
};

/// Options of FrameTaker.
struct FrameTakerOptions {
  IntegrityOptions integrity;
  int frames_after_change = 2;       ///< exposures discarded after a change of the scene (frames in flight)
  double nuc_wait_s = 1;             ///< frames within this time after a correction are rejected
  double max_rejected_share = 0.05;  ///< a larger share, after 100 frames, gives `integrity`
  std::chrono::milliseconds frame_timeout{2000};            ///< longest silence of the camera, then `disconnected`
  std::function<void(const RejectedFrame&)> on_rejected{};  ///< called for every rejected frame; may be empty
  FrameGain gain = FrameGain::constant;                     ///< of the camera's frames: noise is no change of the gain
  std::shared_ptr<const RadiometricScale> scale{};  ///< replaces the scale of every frame; null: each frame's own
};

/// Average of good frames in kelvin, with noise from their differences.
struct AveragedPicture {
  cv::Mat1d kelvin;
  cv::Mat1w lowest, highest;  ///< counts of each pixel over the frames
  int significant_bits = 16;
  /// Standard deviation per pixel and frame, sqrt(mean d^2 / 2) over successive frames without changes of the whole
  /// frame; 0 for a single frame.
  double temporal_noise_k = 0;
  /// Lag-1 correlation of a pixel's noise in successive frames (first_order_correlation()); empty: fewer than eight
  /// frames, or no noise.
  std::optional<double> lag1_correlation;
  /// Unbiased variances per frame of the noise that is common to the pixels of a row or column and changes from frame
  /// to frame. May be negative by chance. Empty for a single frame.
  std::optional<double> row_variance_k2, column_variance_k2;
  /// Largest number that divides all differences between frames: above 1 if a format leaves bits empty or a camera
  /// rounds to steps of several counts; 0: no differences.
  int count_step = 0;
};

/// Returns the noise of a pixel in one frame, in kelvin: temporal_noise_k, over sqrt(1 - rho) if the lag-1 correlation
/// rho is noticeable, because differences of successive frames show only that part of the noise.
[[nodiscard]] double noise_of_one_frame(const AveragedPicture& picture);

/// Takes frames from a started source. One thread at a time.
class FrameTaker {
 public:
  FrameTaker(FrameSource& source, FrameTakerOptions options);

  /// Call after a change of the scene: frames that arrived before `now_ns`, on the clock of Frame::host_time_ns, are
  /// discarded.
  void scene_changed(std::int64_t now_ns);
  /// Commands a non-uniformity correction.
  [[nodiscard]] Result<void> correct_nonuniformity();
  /// Call when the command was carried out: frames are rejected until the waiting time after `now_ns` has passed.
  void corrected(std::int64_t now_ns);

  /// Returns the next good frame. Errors: `integrity` (too many rejected), `disconnected` (lost, or silent for the
  /// frame timeout), `interrupted`.
  [[nodiscard]] Result<Frame> next(std::stop_token stop);
  /// Takes and judges frames while the target changes, until `enough` returns true. `enough` is called before each
  /// request to the source, with the number of requests so far. The scene may move, and a silent source is not an
  /// error. Other errors: those of next().
  [[nodiscard]] Result<void> take_while_presenting(const std::function<bool(std::int64_t calls)>& enough);
  /// Returns the next good frame of a moving scene. No frame is discarded, and a changing picture is not taken for a
  /// correction. Errors: those of next().
  [[nodiscard]] Result<Frame> next_of_moving_scene(std::stop_token stop);
  /// Takes one good frame off the source without counting it as used.
  [[nodiscard]] Result<void> discard(std::stop_token stop);
  /// Called with each frame of an average and its picture in kelvin.
  using EachFrame = std::function<void(const Frame&, const cv::Mat1d& kelvin)>;
  /// Average of `count` good frames. `each` is called for each of them and may be empty.
  [[nodiscard]] Result<AveragedPicture> average(int count, std::stop_token stop, const EachFrame& each = {});

  [[nodiscard]] std::uint64_t used() const { return used_; }
  [[nodiscard]] std::uint64_t lost() const { return gate_.lost(); }
  [[nodiscard]] const NumberingFaults& numbering() const { return gate_.numbering(); }
  [[nodiscard]] std::map<std::string, std::uint64_t> rejected() const;
  /// A sentence about a camera that sends each exposure several times; otherwise empty.
  [[nodiscard]] std::string cadence() const { return cadence_.sentence(); }
  /// Whether any frame stated if it was exposed during a correction.
  [[nodiscard]] bool camera_tells_of_corrections() const { return told_of_corrections_; }
  /// Seconds between the last correction (commanded, reported by the camera, or detected in the picture) and a frame;
  /// negative if none is known.
  [[nodiscard]] double since_nuc_s(const Frame& frame) const;

 private:
  enum class Scene { still, moving };
  [[nodiscard]] Result<Frame> from_source(const std::stop_token& stop);
  [[nodiscard]] Result<void> check_share() const;
  /// Applies the integrity gate, then the checks for corrections.
  [[nodiscard]] std::optional<RejectedFrame> judge(const Frame& frame, Scene scene);
  /// Applies judge(), counts the frame and calls on_rejected. Returns whether the frame is good, or the error that ends
  /// the run.
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
  int to_discard_ = 0;                        ///< exposures in flight at the change
  std::optional<std::int64_t> nuc_ns_;        ///< host time of the last correction
  std::optional<std::int64_t> known_nuc_ns_;  ///< host time of the last correction that was commanded or reported
  std::uint64_t used_ = 0;
  std::uint64_t seen_ = 0;
  std::uint64_t excused_ = 0;  ///< rejections that do not count, because the scene moves
  bool told_of_corrections_ = false;
};

/// A window of a frame in kelvin. Errors: `calibration` if a pixel has no temperature.
[[nodiscard]] Result<cv::Mat1d> window_kelvin(const Frame& frame, const cv::Rect& window);

}  // namespace todbench
