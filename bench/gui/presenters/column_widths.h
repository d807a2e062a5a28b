// SPDX-License-Identifier: GPL-3.0-or-later
// Widths of the columns of a table on a page.
#pragma once

#include <vector>

#include "bench/report/document.h"

namespace todbench {

// Sizes in CSS pixels.
inline constexpr int table_text_px = 10;
inline constexpr double cell_padding = 3, text_width_px = 673;

/// Returns column widths in percent. Columns that fit into an even share have their own width, the narrowest first. The
/// others divide the remaining width in proportion to the square roots of their lengths. If there is room, no column is
/// narrower than its longest word. Without these widths Qt breaks words of narrow columns. Empty if the whole table
/// fits.
[[nodiscard]] std::vector<double> widths_of(const Table& table);
/// Returns the least widths of the columns with which every cell below the header is on one line.
[[nodiscard]] std::vector<double> narrowest_px(const Table& table);

}  // namespace todbench
