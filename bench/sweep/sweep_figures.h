// Drawings of a sweep: tornado, response curves, contours.
#pragma once

#include "bench/report/drawing.h"
#include "bench/report/plot.h"
#include "bench/sweep/sweep_effects.h"

namespace todbench {

/// A bar a parameter from its lowest to its highest mean response (of a drawn one between the ends of its range), the
/// longest first, with the values at its ends. `not_identifiable` where no parameter has two values.
[[nodiscard]] Result<Drawing> tornado(const ResponseEffects& effects, const std::string& id);

/// Mean response at each value with its interval; `invalid_input` for values that are no numbers.
[[nodiscard]] Result<Drawing> response_curve(const ResponseEffects& effects, const ParameterEffect& parameter,
                                             const std::string& id);

/// Means of the response on the grid of two parameters, [x][y].
struct ResponseGrid {
  std::string x_key, y_key;
  std::vector<double> x, y;  ///< increasing
  std::vector<std::vector<double>> mean;
  std::size_t points = 0, least = 0;  ///< of drawn parameters: draws in all squares and in the emptiest
};
/// Of the two parameters of [grid] that explain most, each with two numbers or more; without [grid] of two drawn ones:
/// means over equal squares, as many (8 x 8 to 3 x 3) as leave eight draws or more in each and means whose range is
/// eight times the largest standard error of one. `not_identifiable` where there are none, cells without a task, or too
/// few draws.
[[nodiscard]] Result<ResponseGrid> response_grid(const Sweep& sweep, const SweepTable& table,
                                                 const ResponseEffects& effects);
/// Where a bilinear surface through the grid has this height: stretches of straight lines, each from edge to edge of a
/// cell (marching squares; a saddle is decided by the mean of its corners).
struct ContourStretch {
  Place from, to;
};
[[nodiscard]] std::vector<ContourStretch> contour(const ResponseGrid& grid, double height);
[[nodiscard]] Result<Drawing> contour_plot(const ResponseGrid& grid, const ResponseEffects& effects,
                                           const std::string& id);

}  // namespace todbench
