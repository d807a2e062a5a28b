// SPDX-License-Identifier: GPL-3.0-or-later
// Compares, for each presentation, the position of the plate in the frames with the requested position.
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"
#include "tod/measurement/stage_fit.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Options of PlaceWatch.
struct PlaceWatchOptions {
  /// Deviation above which the run ends with `calibration`; 0: not checked.
  double max_shift_error_px = 0;
  RegistrationOptions registration;
};

/// Properties of the picture that are known before the measurement of the position, in the unit of window_kelvin().
struct ExpectedPicture {
  double contrast = 0;  ///< triangle minus surround
  double noise = 0;     ///< noise of a pixel in one frame; 0: not known
};

/// Position of the middle of the plate in one presentation, in pixels.
struct PlateSeen {
  /// Requested position.
  cv::Point2d asked_px;
  std::optional<cv::Point2d> seen_px;  ///< observed position in the frames; empty: too little contrast
  cv::Point2d standard_error_px;       ///< standard error of seen_px
  cv::Point2d used_off_px{0, 0};       ///< position used to judge frames minus the requested position
  double amplitude = 0;                ///< common contrast of the large triangles, in the unit of window_kelvin()
  /// Standard error of the amplitude. 0: not measured.
  double amplitude_error = 0;
  /// Share of the square of amplitude_error that is due to fixed pattern and is therefore the same in the next
  /// presentation.
  double shared = 1;
};

/// Measures the position of the plate in each presentation. Within a set-up, positions are averaged over the last 1, 2,
/// 4, ... presentations until the standard error is 0.03 px. If no mean reaches this
/// error, the mean over the largest number of presentations is used. The mean replaces the requested position if it
/// differs from the requested position by more than 0.05 px and more than six standard errors. Otherwise the requested
/// position is used unchanged. For a plate at the requested position, six standard errors on two axes are exceeded once
/// in 7e7 measurements. One thread at a time.
class PlaceWatch {
 public:
  explicit PlaceWatch(PlaceWatchOptions options) : options_(options) {}

  /// Returns whether positions are checked.
  [[nodiscard]] bool looks() const { return options_.max_shift_error_px > 0; }
  /// Announces that the plate was located again.
  void set_up_located();
  /// Measures the position in one presentation. `base`: registration of the set-up at shift 0; `asked`: registration at
  /// the shift of this presentation; `frames`: frames of the presentation, at least one. Error: `calibration` with the
  /// likely cause.
  [[nodiscard]] Result<PlateSeen> look(std::span<const Frame> frames, const TargetPlate& mounted_plate,
                                       const Registration& base, const Registration& asked,
                                       const ExpectedPicture& expected, std::int64_t presentation);
  /// Returns the position that is used to judge the next frames, minus the requested position.
  [[nodiscard]] cv::Point2d off_px() const { return used_off_px_; }
  /// Returns an error that was detected but not yet returned. Call this function at the end of the run.
  [[nodiscard]] Result<void> finish() const;
  /// Returns notes for the end of the run.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  /// A measured position, with the data from which the error of a mean over presentations is computed.
  struct Look {
    ShiftSeen place;
    double shared = 1;  ///< share of the variance that is due to fixed pattern and is therefore the same in the next
                        ///< presentation
  };
  struct Mean {
    cv::Point2d off_px, standard_error_px;
    /// Returns the distance from 0 in standard errors.
    [[nodiscard]] double significance() const;
  };
  [[nodiscard]] Mean mean_of_last(std::size_t count) const;
  [[nodiscard]] Result<void> judge();
  [[nodiscard]] Error refused() const;
  [[nodiscard]] std::vector<ShiftSeen> told() const;

  PlaceWatchOptions options_;
  std::vector<Look> looks_;  ///< measured positions in the current set-up
  std::vector<ShiftSeen> earlier_;
  int set_up_ = 0;
  cv::Point2d used_off_px_{0, 0};
  cv::Point2d farthest_px_{0, 0};  ///< largest deviation that was applied
  std::int64_t farthest_presentation_ = 0;
  std::optional<std::size_t> wrong_since_;  ///< value of looks_.size() when the deviation was detected
  double wrong_by_px_ = 0, wrong_error_px_ = 0;
  double largest_turn_px_ = 0;
  std::int64_t not_seen_ = 0, seen_ = 0;
};

}  // namespace todbench
