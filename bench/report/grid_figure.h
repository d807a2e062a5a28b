// A grid of targets as figures: range over contrast, a line for each size.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/report/document.h"
#include "bench/report/plot.h"

namespace todbench {

/// One model's ranges of a grid.
struct GridFigure {
  std::string model;                         ///< its name: "tod"
  std::vector<double> sizes_m, contrasts_k;  ///< magnitudes > 0
  std::vector<std::optional<double>> r75_m;  ///< [size][contrast]
};

/// Six sizes at most, spread over those of the grid; nothing where no target has a range.
[[nodiscard]] std::optional<Plot> grid_plot(const GridFigure& grid);
/// A section with the figure of every model that has one.
[[nodiscard]] Section grid_section(const std::vector<GridFigure>& grids);

}  // namespace todbench
