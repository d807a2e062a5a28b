// SPDX-License-Identifier: GPL-3.0-or-later
// Grid of targets as figures: range over contrast, with a line for each size.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/report/document.h"
#include "bench/report/plot.h"

namespace todbench {

/// Ranges of one model on a grid.
struct GridFigure {
  std::string model;                         ///< name of the model: "tod"
  std::vector<double> sizes_m, contrasts_k;  ///< magnitudes > 0
  std::vector<std::optional<double>> r75_m;  ///< [size][contrast]
};

/// Returns the plot with at most six sizes, spread over the sizes of the grid; empty if no target has a range.
[[nodiscard]] std::optional<Plot> grid_plot(const GridFigure& grid);
/// Returns a section with the figure of every model that has one.
[[nodiscard]] Section grid_section(const std::vector<GridFigure>& grids);

}  // namespace todbench
