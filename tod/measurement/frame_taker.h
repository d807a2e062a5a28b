// Frames that may be measured: past the integrity gate, exposed after the last change, not during a correction.
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

namespace todbench {

/// A frame that was not used, and why.
struct RejectedFrame {
  std::uint64_t sequence = 0;
  Rejection reason = Rejection::incomplete;
  std::optional<CorrectionSign> seen{};  ///< the picture in which a correction was seen
};

struct FrameTakerOptions {
  IntegrityOptions integrity;
  int frames_after_change = 2;
  double nuc_wait_s = 1;
  double max_rejected_share = 0.05;
  std::chrono::milliseconds frame_timeout{2000};
  std::function<void(const RejectedFrame&)> on_rejected{};  ///< told of every one; may be empty
  std::shared_ptr<const RadiometricScale> scale{};          ///< of every frame, in place of its own; null: its own
};

/// An average of good frames in kelvin, with what their differences say of a pixel's noise.
struct AveragedPicture {
  cv::Mat1d kelvin;
  cv::Mat1w lowest, highest;  ///< counts of each pixel over the frames
  int significant_bits = 16;
  /// sd per pixel and frame, sqrt(mean d^2 / 2) over successive frames, changes of the whole frame left out; 0 for a
  /// single frame.
  double temporal_noise_k = 0;
  /// Of a pixel in successive frames (first_order_correlation()); nothing: fewer than eight frames, or no noise.
  std::optional<double> lag1_correlation;
  /// Largest number of which all differences between frames are multiples: above 1 where a format leaves bits empty or
  /// a camera rounds more coarsely than it counts; 0: no differences.
  int count_step = 0;
};

/// Takes frames from a started source. One thread at a time.
class FrameTaker {
 public:
  FrameTaker(FrameSource& source, FrameTakerOptions options);

  /// What the camera looks at has changed: frames that arrived before `now_ns`, on the clock of Frame::host_time_ns,
  /// are discarded.
  void scene_changed(std::int64_t now_ns);
  /// Commands a non-uniformity correction.
  [[nodiscard]] Result<void> correct_nonuniformity();
  /// The command was carried out at `now_ns`: frames are kept out until it has passed.
  void corrected(std::int64_t now_ns);

  /// The next good frame. Errors: `integrity` (too many rejected), `disconnected` (lost, or silent for the frame
  /// timeout), `interrupted`.
  [[nodiscard]] Result<Frame> next(std::stop_token stop);
  /// Takes frames, and judges them, until `enough` says so: asked before every call of the source with the number of
  /// calls so far. For the time in which the target changes: the scene may move, and a source that is silent is no
  /// error. Errors: those of next() but for the silence.
  [[nodiscard]] Result<void> take_while_presenting(const std::function<bool(std::int64_t calls)>& enough);
  /// The next good frame while the scene moves, on its way included: nothing is discarded, and a picture that changes
  /// is no correction. Errors: those of next().
  [[nodiscard]] Result<Frame> next_of_moving_scene(std::stop_token stop);
  /// Takes one good frame off the source without counting it as used.
  [[nodiscard]] Result<void> discard(std::stop_token stop);
  /// Average of `count` good frames.
  [[nodiscard]] Result<AveragedPicture> average(int count, std::stop_token stop);

  [[nodiscard]] std::uint64_t used() const { return used_; }
  [[nodiscard]] std::uint64_t lost() const { return gate_.lost(); }
  [[nodiscard]] const NumberingFaults& numbering() const { return gate_.numbering(); }
  [[nodiscard]] std::map<std::string, std::uint64_t> rejected() const;
  /// Whether a frame said if it was exposed during a correction.
  [[nodiscard]] bool camera_tells_of_corrections() const { return told_of_corrections_; }
  /// Seconds between the last correction (commanded, told by the camera, or seen in the picture) and a frame; negative
  /// when none is known.
  [[nodiscard]] double since_nuc_s(const Frame& frame) const;

 private:
  enum class Scene { still, moving };
  [[nodiscard]] Result<Frame> from_source(const std::stop_token& stop);
  [[nodiscard]] Result<void> check_share() const;
  /// The gate, then what is known of corrections.
  [[nodiscard]] std::optional<RejectedFrame> judge(const Frame& frame, Scene scene);
  /// judge(), with everybody told who wants to know. Whether the frame is good, or why the run cannot go on.
  [[nodiscard]] Result<bool> accept(const Frame& frame, Scene scene);
  void note_told_correction(const Frame& frame);
  [[nodiscard]] std::optional<CorrectionSign> see_correction(const Frame& frame, std::optional<Rejection> rejection,
                                                             Scene scene);

  FrameSource& source_;
  FrameTakerOptions options_;
  IntegrityGate gate_;
  CorrectionWatch watch_{CorrectionWatchOptions{}};
  std::int64_t valid_from_ns_ = 0;            ///< host time of the last change of scene
  int to_discard_ = 0;                        ///< exposures still in flight after the change
  std::optional<std::int64_t> nuc_ns_;        ///< host time of the last correction
  std::optional<std::int64_t> known_nuc_ns_;  ///< of the last that was commanded, or that the camera told of
  std::uint64_t used_ = 0;
  std::uint64_t seen_ = 0;
  std::uint64_t excused_ = 0;  ///< pictures of a moving scene that look bad
  bool told_of_corrections_ = false;
};

/// A window of a frame in kelvin. `calibration` when a pixel has no temperature.
[[nodiscard]] Result<cv::Mat1d> window_kelvin(const Frame& frame, const cv::Rect& window);

}  // namespace todbench
