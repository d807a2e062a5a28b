// SPDX-License-Identifier: GPL-3.0-or-later
// Windows with bars and spots that the observer judged, kept for human observers.
#pragma once

#include <cstddef>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "tod/measures/slanted_edge.h"

namespace todbench {

/// A group of four bars, or a spot.
struct KeptPlace {
  std::string name;
  EdgeAxis axis = EdgeAxis::x;
  double frequency_per_pitch = 0;  ///< 0: a spot
  double size_px = 0;              ///< side of the spot; 0: bars
  int side_px = 0;                 ///< side of the windows
};

/// The two windows of a KeptPlace in one frame, as the observer judges them: in kelvin, each minus its mean.
struct KeptPicture {
  std::size_t place = 0;  ///< index in KeptBars::places
  int set_up = 0;
  double contrast_k = 0;  ///< reported by the target, signed
  cv::Mat1f target;       ///< four bars, or the spot
  cv::Mat1f other;        ///< five bars, or an empty part of the plate
};

/// Kept windows, and the groups of bars and spots to which they belong.
struct KeptBars {
  std::vector<KeptPlace> places{};
  std::vector<KeptPicture> pictures{};
};

/// Keeps the windows of the first frames for each group of bars or spot, each contrast and each set-up.
class BarsKeeper {
 public:
  /// `frames`: number of frames kept for each contrast of each set-up; 0: none.
  explicit BarsKeeper(int frames) : frames_(frames) {}
  [[nodiscard]] bool keeps() const { return frames_ > 0; }
  void add(KeptPicture picture);
  /// Returns the pictures of all elements of `places` that have a name. The indices of KeptPicture::place refer to
  /// `places`.
  [[nodiscard]] KeptBars of(const std::vector<KeptPlace>& places) const;

 private:
  int frames_ = 0;
  std::vector<KeptPicture> pictures_{};
  std::map<std::tuple<std::size_t, int, double>, int> count_{};
};

}  // namespace todbench
