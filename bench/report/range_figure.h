// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of range models: probability over range as a figure, and results as a table.
#pragma once

#include <span>
#include <string>

#include "bench/report/document.h"
#include "bench/report/plot.h"
#include "tod/range/model_range.h"

namespace todbench {

/// Returns the plot of probability over range: a line for each model with a result, and marks for the 75 % ranges with
/// their intervals.
[[nodiscard]] Plot range_plot(std::span<const ModelRange> models);
/// Returns the figure as an SVG file. Errors: `invalid_input` (no model has a curve).
[[nodiscard]] Result<std::string> range_svg(std::span<const ModelRange> models);

/// Text of the page in addition to the models.
struct RangePage {
  std::string target;  ///< "4.9 m, 2 K"
  std::string air;
  std::vector<std::string> notes;
};
/// Returns figure, table and assumptions.
[[nodiscard]] Document range_page(std::span<const ModelRange> models, const RangePage& page);

}  // namespace todbench
