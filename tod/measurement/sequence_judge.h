// SPDX-License-Identifier: GPL-3.0-or-later
// Observers of a moving target, which decide from several frames of one pass.
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/base/rng.h"
#include "hvs/observer/template_observer.h"

namespace todbench {

/// Use of the frames of a pass by an observer.
enum class SequenceObserver {
  single_frame,  ///< judges the first frame only
  /// Adds the scores of all frames, computed at the true position of the target: an upper bound for pursuit by the eye.
  tracking_sum,
  /// Averages all frames and judges the mean at the target's position in the middle of the pass: persistence without
  /// pursuit.
  static_sum,
  /// Combines all frames into one picture with twice the sampling rate, using the known position of the target in each
  /// frame (super_resolve()). The observer evaluates this picture.
  super_resolution,
};
inline constexpr std::array all_sequence_observers{SequenceObserver::single_frame, SequenceObserver::tracking_sum,
                                                   SequenceObserver::static_sum, SequenceObserver::super_resolution};
[[nodiscard]] std::string_view to_string(SequenceObserver observer);

/// One triangle in the frames of a pass.
struct SeenSequence {
  std::span<const cv::Mat1f> frames;  ///< whole frames in kelvin, at least one
  /// Position of the triangle's centroid in each frame, with pixel centres at integers.
  std::vector<cv::Point2d> places;
  double contrast_k = 0;
  double noise_k = 0;  ///< noise of the sensor in one frame
};

/// Judges triangles of several sizes. Internal noise is drawn once for each decision, independent of the number of
/// frames. One thread at a time.
class SequenceJudge {
 public:
  /// Prepares the observers. `sizes` in samples. Errors: those of the observer.
  [[nodiscard]] static Result<SequenceJudge> prepare(TemplateObserver& observer, std::span<const double> sizes);

  [[nodiscard]] std::size_t sizes() const { return sizes_.size(); }
  /// Returns the side, in samples, of a window that is large enough for every observer at this size, including the
  /// search.
  [[nodiscard]] int window_samples(std::size_t size) const;
  /// Returns the chosen alternative. Precondition: the windows round all positions are inside the frames.
  [[nodiscard]] int choose(SequenceObserver kind, std::size_t size, const SeenSequence& seen,
                           const RandomStream& noise) const;

 private:
  /// Observer and bank of one size. The bank extends half a sample beyond the search range of the observer. The search
  /// can therefore be centred on any true position between two samples.
  struct PreparedSize {
    std::shared_ptr<const PreparedObserver> observer;
    std::shared_ptr<const PreparedObserver> finer;  ///< observer for a picture on a grid twice as fine
    std::shared_ptr<const TemplateBank> bank;
  };
  [[nodiscard]] int tracked(const PreparedSize& size, const SeenSequence& seen, const RandomStream& noise) const;
  [[nodiscard]] int averaged(const PreparedSize& size, const SeenSequence& seen, const RandomStream& noise) const;
  [[nodiscard]] int resolved(const PreparedSize& size, const SeenSequence& seen, const RandomStream& noise) const;

  TemplateObserverSpec spec_;
  int steps_ = 8, reach_ = 8, wide_reach_ = 12;
  std::vector<PreparedSize> sizes_;
};

}  // namespace todbench
