// Range models side by side: P against range as a figure, the answers as a table.
#pragma once

#include <span>
#include <string>

#include "bench/report/document.h"
#include "bench/report/plot.h"
#include "tod/range/model_range.h"

namespace todbench {

/// P over range, a line for each model that answers, with the 75 % ranges and their intervals on a line of their own.
[[nodiscard]] Plot range_plot(std::span<const ModelRange> models);
/// The figure as a file of its own. `invalid_input` where no model has a curve.
[[nodiscard]] Result<std::string> range_svg(std::span<const ModelRange> models);

/// What the page says beside the models.
struct RangePage {
  std::string target;  ///< "4.9 m, 2 K"
  std::string air;
  std::vector<std::string> notes;
};
/// Figure, table and assumptions.
[[nodiscard]] Document range_page(std::span<const ModelRange> models, const RangePage& page);

}  // namespace todbench
