// SPDX-License-Identifier: GPL-3.0-or-later
// Widths of the columns of a table on a page.
#pragma once

#include <vector>

#include "bench/report/document.h"

namespace todbench {

// Sizes in CSS pixels.
inline constexpr int table_text_px = 10;
inline constexpr double cell_padding = 3, text_width_px = 673;

/// Returns column widths in percent; empty if the whole table fits. Starting with the narrowest column, each column
/// whose text fits into an even share of the remaining width gets the width of its text. The other columns divide the
/// rest in proportion to the square roots of their text lengths. If there is room, no column is narrower than its
/// longest word. Without these widths, Qt breaks words in narrow columns.
[[nodiscard]] std::vector<double> widths_of(const Table& table);
/// Returns the least width of each column at which every cell below the header fits on one line.
[[nodiscard]] std::vector<double> narrowest_px(const Table& table);

}  // namespace todbench
