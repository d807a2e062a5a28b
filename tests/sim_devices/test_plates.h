// SPDX-License-Identifier: GPL-3.0-or-later
// Plates for tests: five rows of four triangles, spaced like the shipped ones.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tod/plate/target_plate.h"

namespace todbench::test {

/// Rows from top to bottom of the given sizes; apexes differ from row to row and between `variant`s.
inline TargetPlate plate_of_rows(const std::string& name, const std::array<double, 5>& sizes_mm, int variant) {
  TargetPlate plate{.name = name, .description = "", .width_mm = 200, .height_mm = 280, .triangles = {}};
  const std::array<std::array<int, 4>, 6> apexes{
      {{3, 0, 2, 3}, {2, 0, 3, 1}, {1, 1, 0, 2}, {0, 2, 1, 3}, {1, 3, 0, 2}, {2, 1, 1, 0}}};
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 4; ++column) {
      plate.triangles.push_back(
          {.name = "row " + std::to_string(row + 1) + ", triangle " + std::to_string(column + 1),
           .position_mm = {-71.5 + 47.6 * column + 0.37 * row, -112.0 + 55.9 * row + 0.53 * column},
           .size_mm = sizes_mm[static_cast<std::size_t>(row)],
           .apex = static_cast<Apex>(
               apexes[static_cast<std::size_t>((row + variant) % 6)][static_cast<std::size_t>(column)])});
    }
  }
  return plate;
}

/// Ten sizes over two plates for an SC2000 at 2 m (2.617 mm per pixel).
inline std::vector<TargetPlate> two_plates() {
  return {plate_of_rows("a", {13.5, 4.41, 3.04, 6.4, 9.3}, 0), plate_of_rows("b", {11.2, 3.66, 2.52, 5.31, 7.71}, 1)};
}

}  // namespace todbench::test
