// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the displacements that a super-resolution scan assumes. The large triangles are located in the frames at each
// position of the scan.
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

/// Frames of one scene, grouped by the assumed scan position.
class ScanFrames {
 public:
  /// Adds a frame. `kelvin`: picture of the camera. Ignores frames without a stated scan position.
  void add(const Frame& frame, const cv::Mat1d& kelvin);

  struct Place {
    cv::Mat1d sum, last;
    int frames = 0;
  };
  /// Returns the sums by scan position. Key: displacement in x and y, in pixels.
  [[nodiscard]] const std::map<std::array<double, 2>, Place>& places() const { return places_; }
  /// Returns the noise of a pixel in one frame, from successive frames at one scan position. Empty: no position
  /// occurred twice.
  [[nodiscard]] std::optional<double> noise() const;

 private:
  std::map<std::array<double, 2>, Place> places_;
  double squares_ = 0;
  int differences_ = 0;
};

/// Largest permitted deviation of an element of StageFit::seen_per_asked from the unit matrix, in addition to four
/// standard errors. A scan with half the assumed step has a deviation of 0.5; frames at rest have a deviation of 1.
inline constexpr double most_scan_deviation = 0.25;

/// Checks a scan with the data of all set-ups. Fixed pattern displaces the triangles equally at every scan position.
/// This displacement is part of the common origin of a set-up, so the standard errors contain only the temporal noise.
class ScanWatch {
 public:
  /// Adds the frames of a set-up or contrast. `registration`: registration in the mean of the frames. Error:
  /// `calibration` if this set-up, or all set-ups until now together, contradict the scan.
  [[nodiscard]] Result<void> look(const ScanFrames& frames, const TargetPlate& mounted_plate,
                                  const Registration& registration, const RegistrationOptions& options);

 private:
  std::vector<ShiftSeen> places_;
  int set_ups_ = 0;
};

}  // namespace todbench
