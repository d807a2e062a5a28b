// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the displacements that a super-resolution scan assumes, with the large triangles in frames at each place of
// the scan.
#pragma once

#include <array>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"
#include "tod/measurement/stage_fit.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Frames of one scene, grouped by the assumed place of the scan.
class ScanFrames {
 public:
  /// Adds a frame. `kelvin`: the camera's own picture. Ignores frames without a stated place.
  void add(const Frame& frame, const cv::Mat1d& kelvin);

  struct Place {
    cv::Mat1d sum, last;
    int frames = 0;
  };
  /// Returns the sums by place. Key: displacement x and y in pixels.
  [[nodiscard]] const std::map<std::array<double, 2>, Place>& places() const { return places_; }
  /// Returns the noise of a pixel in one frame, from successive frames of one place; empty: no place occurred twice.
  [[nodiscard]] std::optional<double> noise() const;

 private:
  std::map<std::array<double, 2>, Place> places_;
  double squares_ = 0;
  int differences_ = 0;
};

/// Largest deviation of the elements of StageFit::seen_per_asked from the unit matrix, in addition to four standard
/// errors. A scan of half the step deviates by 0.5, frames at rest by 1.
inline constexpr double most_scan_deviation = 0.25;

/// Checks a scan from set-up to set-up. Fixed pattern displaces the triangles equally at every place of the scan. It is
/// therefore part of the common origin of a set-up, and standard errors contain only the temporal noise.
class ScanWatch {
 public:
  /// Adds a set-up or contrast. `registration`: registration in the mean of the frames. Error: `calibration` if this
  /// set-up, or all set-ups so far together, contradict the scan.
  [[nodiscard]] Result<void> look(const ScanFrames& frames, const TargetPlate& mounted_plate,
                                  const Registration& registration, const RegistrationOptions& options);

 private:
  std::vector<ShiftSeen> places_;
  int set_ups_ = 0;
};

}  // namespace todbench
