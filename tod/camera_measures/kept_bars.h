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
  int side_px = 0;                 ///< of the windows
};

/// Both windows of a place in one frame, in kelvin relative to the mean of each window, as the observer judges them.
struct KeptPicture {
  std::size_t place = 0;  ///< index in KeptBars::places
  int set_up = 0;
  double contrast_k = 0;  ///< reported by the target, signed
  cv::Mat1f target;       ///< four bars, or the spot
  cv::Mat1f other;        ///< five bars, or an empty part of the plate
};

/// Kept windows and their places.
struct KeptBars {
  std::vector<KeptPlace> places{};
  std::vector<KeptPicture> pictures{};
};

/// Keeps the first frames of each place, contrast and set-up.
class BarsKeeper {
 public:
  /// `frames`: number kept for each contrast of each set-up; 0: none.
  explicit BarsKeeper(int frames) : frames_(frames) {}
  [[nodiscard]] bool keeps() const { return frames_ > 0; }
  void add(KeptPicture picture);
  /// Returns the pictures of all places with a name. `places` has one element for each place of add().
  [[nodiscard]] KeptBars of(const std::vector<KeptPlace>& places) const;

 private:
  int frames_ = 0;
  std::vector<KeptPicture> pictures_{};
  std::map<std::tuple<std::size_t, int, double>, int> count_{};
};

}  // namespace todbench
