// SPDX-License-Identifier: GPL-3.0-or-later
// Monitor in front of the camera: the bench draws the plate on it, with mountings and shifts.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/pattern/plate_picture.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Shows levels from 0 to 1 and returns the levels on the screen, in the same size and scale.
using ShowLevels = std::function<Result<cv::Mat1f>(const cv::Mat1f& levels)>;

/// Transfer curve of a monitor: light as a function of level, both from 0 (black) to 1 (white).
struct DisplayTone {
  double gamma = 1;  ///< light = level^gamma, > 0
  /// Measured luminance at equally spaced levels from black to white, increasing, in any unit; interpolated linearly.
  /// More than two values replace gamma.
  std::vector<double> luminance{0, 1};
  /// Returns whether the light is proportional to the level.
  [[nodiscard]] bool in_proportion() const { return luminance.size() < 3 && gamma == 1; }
  /// Returns the light of a level, both from 0 to 1.
  [[nodiscard]] double light_of(double level) const;
  /// Returns the level of a light, both from 0 to 1.
  [[nodiscard]] double level_of(double light) const;
};

/// Options of display_target().
struct DisplayTargetOptions {
  std::vector<TargetPlate> plates;  ///< plates in identity mounting
  DisplayGeometry display{};
  double span_k = 1;  ///< contrast in kelvin that the camera observes between white and black, > 0
  DisplayTone tone{};
  std::vector<double> delta_t_k{};        ///< contrasts that will be requested, checked at opening
  std::chrono::milliseconds settle{200};  ///< settling time of the panel
  std::string description = "display";    ///< description for the report
};

/// Creates a target that draws on a monitor. Contrasts are differences of light around half of the maximum. Background
/// and pattern are levels of an 8-bit screen; the pattern has the level whose light is nearest to the contrast. The
/// target reports the contrast that results from both levels. Mountings and sub-pixel shifts are drawn by exact area: a
/// pixel has the level of the mean light over its area. After each picture, every pixel of the screen must be within
/// half a level of the drawn level. Errors of present(): `invalid_input` (unknown plate, plate larger than the display,
/// contrast beyond the span, or with fewer than 16 levels, which would shift edges by more than 1/32 of a pixel);
/// `integrity` (the screen shows other levels); those of `show`.
[[nodiscard]] std::unique_ptr<Target> display_target(DisplayTargetOptions options, ShowLevels show);

/// Background and pattern level for a contrast.
struct DisplayLevels {
  int ground = 0, pattern = 0;  ///< 0 to 255
  double light_difference = 0;  ///< pattern minus background, as a fraction of white minus black; signed
};
/// Returns the levels for `contrast`, a fraction of the span from -1 to 1.
[[nodiscard]] DisplayLevels display_levels(double contrast, const DisplayTone& tone);

/// Creates the target together with the program that shows its pictures. First shows a uniform picture at half
/// luminance. Errors, before a plate is drawn: `invalid_input` (a centred plate does not fit on the display, a contrast
/// cannot be shown, or the picture is larger than the screen), `not_found` (the program cannot be started, or ends
/// because there is no screen); otherwise the message of the program.
[[nodiscard]] Result<std::unique_ptr<Target>> open_display_target(DisplayTargetOptions options,
                                                                  const std::string& command);

/// Starts the program that shows pictures: a shell command, `todbench-gui --screen N --pictures` or a program that
/// follows the contract of modules (docs/reference/modules.md). The calling process must ignore SIGPIPE. Exit codes: 2,
/// the picture was refused (`invalid_input`); 4 and 127, no screen or no such program (`not_found`).
[[nodiscard]] Result<ShowLevels> shown_by_program(const std::string& command);

}  // namespace todbench
