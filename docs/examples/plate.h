// SPDX-License-Identifier: GPL-3.0-or-later
// A plate as its drawing states it: four rows of four triangles, all over a range of sizes. Places in mm from the
// middle of the plate, x to the right, y down.
#pragma once

#include "tod/plate/target_plate.h"

inline todbench::TargetPlate example_plate() {
  using todbench::Apex;
  todbench::TargetPlate plate{.name = "example", .description = "", .width_mm = 200, .height_mm = 240, .triangles = {}};
  const double sizes_mm[4] = {13.5, 3.2, 4.4, 6.8};
  const Apex apexes[4][4] = {{Apex::left, Apex::up, Apex::down, Apex::left},
                             {Apex::down, Apex::up, Apex::left, Apex::right},
                             {Apex::right, Apex::right, Apex::up, Apex::down},
                             {Apex::up, Apex::down, Apex::right, Apex::left}};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      plate.triangles.push_back({.name = "row " + std::to_string(row + 1) + ", triangle " + std::to_string(column + 1),
                                 .position_mm = {-71.5 + 47.6 * column + 0.37 * row, -84.0 + 56 * row + 0.53 * column},
                                 .size_mm = sizes_mm[row],
                                 .apex = apexes[row][column]});
    }
  }
  return plate;
}
