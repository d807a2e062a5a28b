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

struct DisplayTargetOptions {
  std::vector<TargetPlate> plates;  ///< in identity mounting
  DisplayGeometry display{};
  double span_k = 1;                      ///< contrast that the camera shows of black beside white, > 0
  std::chrono::milliseconds settle{200};  ///< until the panel has changed
  std::string description = "display";    ///< for the report
};

/// Contrasts are steps of an 8-bit screen round its middle level: ground and pattern are the levels whose difference is
/// nearest to the contrast, which is what the target says it reached. Every mounting and sub-pixel shift is drawn by
/// exact area. After each picture what the screen shows has to be what was drawn, every pixel to half a level.
/// present(): `invalid_input` for a plate that is not known or leaves the display, a contrast beyond the span or of
/// fewer than 16 levels (edges would be off by more than 1/32 of a pixel); `integrity` where the screen shows something
/// else; whatever `show` says.
[[nodiscard]] std::unique_ptr<Target> display_target(DisplayTargetOptions options, ShowLevels show);

/// The program that shows pictures, `todbench-gui --screen N --pictures` or one that keeps the contract of modules
/// (docs/modules.md): a command for a shell. The program has to ignore SIGPIPE.
[[nodiscard]] Result<ShowLevels> shown_by_program(const std::string& command);

}  // namespace todbench
