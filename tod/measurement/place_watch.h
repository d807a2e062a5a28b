// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the plate's place in the frames of each presentation with the requested place.
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

/// Properties of the picture that are known before its place is measured, in the unit of window_kelvin().
struct ExpectedPicture {
  double contrast = 0;  ///< triangle minus surround
  double noise = 0;     ///< noise of a pixel in one frame; 0: not known
};

/// Place of the plate's middle in one presentation, in pixels.
struct PlateSeen {
  cv::Point2d asked_px;                ///< requested place
  std::optional<cv::Point2d> seen_px;  ///< observed place in the frames; empty: too little contrast
  cv::Point2d standard_error_px;       ///< of seen_px
  cv::Point2d used_off_px{0, 0};       ///< place at which frames are judged minus the requested place
  double amplitude = 0;                ///< common contrast of the large triangles, in the unit of window_kelvin()
  double amplitude_error = 0;          ///< its standard error; 0: not measured
  double shared = 1;  ///< share of this error's variance that recurs in the next presentation, due to fixed pattern
};

/// Measures the place in each presentation. Within a set-up, places are averaged over as many of the last presentations
/// (1, 2, 4, ...) as a standard error of 0.03 px requires. Once the place has this standard error, or the smallest that
/// the set-up permits, it may replace the requested place: the difference must exceed 0.05 px and six standard errors.
/// Otherwise the requested place is kept bit for bit. A plate in its correct place exceeds six standard errors on two
/// axes once in 7e7 measurements. One thread at a time.
class PlaceWatch {
 public:
  explicit PlaceWatch(PlaceWatchOptions options) : options_(options) {}

  /// Returns whether places are checked.
  [[nodiscard]] bool looks() const { return options_.max_shift_error_px > 0; }
  /// Announces that the plate was located again.
  void set_up_located();
  /// Measures the place in one presentation. `base`: registration of the set-up at shift 0; `asked`: registration at
  /// the shift of this presentation; `frames`: frames of the presentation, at least one. Error: `calibration` with the
  /// likely cause.
  [[nodiscard]] Result<PlateSeen> look(std::span<const Frame> frames, const TargetPlate& mounted_plate,
                                       const Registration& base, const Registration& asked,
                                       const ExpectedPicture& expected, std::int64_t presentation);
  /// Returns the place at which the next frames are judged minus the requested place.
  [[nodiscard]] cv::Point2d off_px() const { return used_off_px_; }
  /// Returns an error that was detected but not yet returned; call at the end of the run.
  [[nodiscard]] Result<void> finish() const;
  /// Returns notes for the end of the run.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  /// A measured place, with the data for the error of a mean over presentations.
  struct Look {
    ShiftSeen place;
    double shared = 1;  ///< share of the variance that recurs in the next presentation, due to fixed pattern
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
  std::vector<Look> looks_;  ///< places in the current set-up
  std::vector<ShiftSeen> earlier_;
  int set_up_ = 0;
  cv::Point2d used_off_px_{0, 0};
  cv::Point2d farthest_px_{0, 0};  ///< largest deviation that was applied
  std::int64_t farthest_presentation_ = 0;
  std::optional<std::size_t> wrong_since_;  ///< number of looks when the deviation was detected
  double wrong_by_px_ = 0, wrong_error_px_ = 0;
  double largest_turn_px_ = 0;
  std::int64_t not_seen_ = 0, seen_ = 0;
};

}  // namespace todbench
