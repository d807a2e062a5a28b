// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings of a sweep: tornado, response curves, contours.
#pragma once

#include "bench/report/drawing.h"
#include "bench/report/plot.h"
#include "bench/sweep/sweep_effects.h"

namespace todbench {

/// Draws one bar per parameter from its lowest to its highest mean response (for a drawn parameter at the limits of its
/// range). The longest bar is the first. Each bar has the values at both ends. Errors: `not_identifiable` if no
/// parameter has two values.
[[nodiscard]] Result<Drawing> tornado(const ResponseEffects& effects, const std::string& id);

/// Draws the mean response at each value with its interval. Errors: `invalid_input` for values that are not numbers.
[[nodiscard]] Result<Drawing> response_curve(const ResponseEffects& effects, const ParameterEffect& parameter,
                                             const std::string& id);

/// Means of the response on the grid of two parameters, [x][y].
struct ResponseGrid {
  std::string x_key, y_key;
  std::vector<double> x, y;  ///< increasing
  std::vector<std::vector<double>> mean;
  /// For drawn parameters: number of draws in all squares, and in the square with the fewest draws.
  std::size_t points = 0, least = 0;
};
/// Computes the grid of the two parameters of [grid] with the largest shares of the variance, each with two numbers or
/// more. Without [grid], two drawn parameters are used, with means over equal squares. The number of squares is the
/// largest from 3 x 3 to 8 x 8 with at least eight draws in each square, and with means that span at least eight times
/// the largest standard error of a mean. Errors: `not_identifiable` (no such parameters, cells without a task, or too
/// few draws).
[[nodiscard]] Result<ResponseGrid> response_grid(const Sweep& sweep, const SweepTable& table,
                                                 const ResponseEffects& effects);
/// Contour line of a bilinear surface through the grid at one height, as straight segments from edge to edge of a cell
/// (marching squares). The mean of the corners decides a saddle.
struct ContourStretch {
  Place from, to;
};
/// Returns the contour line at a height.
[[nodiscard]] std::vector<ContourStretch> contour(const ResponseGrid& grid, double height);
/// Draws the contour lines of the grid.
[[nodiscard]] Result<Drawing> contour_plot(const ResponseGrid& grid, const ResponseEffects& effects,
                                           const std::string& id);

}  // namespace todbench
