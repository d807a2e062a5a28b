// A monitor before the camera: the bench draws the plate on it, as it would move a plate.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/pattern/plate_picture.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Shows levels from 0 to 1 and answers with what is on the screen, as large and in the same levels.
using ShowLevels = std::function<Result<cv::Mat1f>(const cv::Mat1f& levels)>;

/// The light that a monitor makes of its levels, both from 0 to 1, of black to that of white.
struct DisplayTone {
  double gamma = 1;  ///< light is level^gamma, > 0
  /// As measured, of equally spaced levels from black to white, rising, in any unit; straight lines between them. More
  /// than two stand in place of gamma.
  std::vector<double> luminance{0, 1};
  [[nodiscard]] bool in_proportion() const { return luminance.size() < 3 && gamma == 1; }
  [[nodiscard]] double light_of(double level) const;
  [[nodiscard]] double level_of(double light) const;
};

struct DisplayTargetOptions {
  std::vector<TargetPlate> plates;  ///< in identity mounting
  DisplayGeometry display{};
  double span_k = 1;  ///< contrast that the camera shows of black beside white, > 0
  DisplayTone tone{};
  std::vector<double> delta_t_k{};        ///< that will be asked for, checked when the target is opened
  std::chrono::milliseconds settle{200};  ///< until the panel has changed
  std::string description = "display";    ///< for the report
};

/// Contrasts are differences of light round half of it: ground and pattern are levels of an 8-bit screen, the pattern
/// the one whose light is nearest to the contrast; what these two make is what the target says it reached. Every
/// mounting and sub-pixel shift is drawn by exact area: a pixel has the level whose light is the mean over its area.
/// After each picture what the screen shows has to be what was drawn, every pixel to half a level.
/// present(): `invalid_input` for a plate that is not known or leaves the display, a contrast beyond the span or of
/// fewer than 16 levels (edges would be off by more than 1/32 of a pixel); `integrity` where the screen shows something
/// else; whatever `show` says.
[[nodiscard]] std::unique_ptr<Target> display_target(DisplayTargetOptions options, ShowLevels show);

/// Ground and pattern of a contrast.
struct DisplayLevels {
  int ground = 0, pattern = 0;  ///< of 255
  double light_difference = 0;  ///< of pattern and ground, as a part of that of white and black; signed
};
/// `contrast`: the part of the span, from -1 to 1.
[[nodiscard]] DisplayLevels display_levels(double contrast, const DisplayTone& tone);

/// The target with the program that shows its pictures. Shows a flat picture of half the light first. Errors, before a
/// plate is drawn: `invalid_input` where a plate leaves the display in the middle of it, a contrast cannot be shown or
/// the picture is larger than the screen, `not_found` where the program cannot be started or ends because there is no
/// screen; what it said.
[[nodiscard]] Result<std::unique_ptr<Target>> open_display_target(DisplayTargetOptions options,
                                                                  const std::string& command);

/// The program that shows pictures, `todbench-gui --screen N --pictures` or one that keeps the contract of modules
/// (docs/modules.md): a command for a shell. The program has to ignore SIGPIPE. A program that ends with exit code 2
/// refused the picture (`invalid_input`); 4 and 127, it found no screen or was not found (`not_found`).
[[nodiscard]] Result<ShowLevels> shown_by_program(const std::string& command);

}  // namespace todbench
