// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of a pixel from differences of frames of one scene at several lags.
#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace todbench {

/// Gain of the frames of one scene.
enum class FrameGain {
  constant,
  changing,  ///< gain control: the gain differs between frames
};

/// Returns the picture `to` minus the picture `from`; both show the same scene. With a changing gain, the two pictures
/// also differ by a multiple of the scene, which is not noise. The part of the difference that is proportional to their
/// mean is therefore removed by least squares. The noise of the result corresponds to the gain 2 a b / (a + b), where a
/// and b are the gains of the two pictures.
[[nodiscard]] cv::Mat1d difference_of(const cv::Mat1d& from, const cv::Mat1d& to, FrameGain gain);

/// Computes differences of pictures at three lags: one frame, 3/8 and 3/4 of the planned number of frames. Removes
/// offsets of whole frames. Stores a quarter of the frames. One thread at a time.
class LagDifferences {
 public:
  /// `frames`: planned number, at least 2.
  explicit LagDifferences(int frames, FrameGain gain = FrameGain::constant);
  /// Adds a picture. `sequence`: number of the exposure, increasing.
  void add(std::uint64_t sequence, const cv::Mat1d& picture);

  /// Returns half of the mean squared difference of successive frames; 0 without successive frames.
  [[nodiscard]] double successive_variance() const { return successive_.mean(); }
  /// Returns the variance of a pixel in one frame. The result is exact for white noise, for noise of first order, and
  /// for moving means over at most 3/8 of the frames. With too few frames it is the successive variance.
  [[nodiscard]] double variance() const;
  /// Returns variance() / successive_variance(). The ratio is above 1 for noise with memory, and 1 without noise.
  [[nodiscard]] double memory() const;

 private:
  struct AtLag {
    double squares = 0;
    int pairs = 0;
    void add(const cv::Mat1d& difference);
    [[nodiscard]] double mean() const { return pairs > 0 ? squares / pairs : 0; }
  };
  struct Kept {
    std::uint64_t sequence = 0;
    cv::Mat1d picture;
  };

  FrameGain gain_;
  std::size_t references_;
  std::uint64_t lag_;
  std::vector<Kept> kept_;  ///< the first frames
  std::optional<Kept> last_;
  AtLag successive_, at_lag_, at_twice_;
};

}  // namespace todbench
