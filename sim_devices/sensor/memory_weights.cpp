// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/memory_weights.h"

#include <cmath>

namespace todbench {

std::vector<double> memory_weights(double rho) {
  constexpr double shortest_memory = 0.01;
  std::vector<double> weights;
  double squares = 0;
  for (double power = 1; power >= shortest_memory; power *= rho) {
    weights.push_back(power);
    squares += power * power;
  }
  for (double& weight : weights) weight /= std::sqrt(squares);
  return weights;
}

}  // namespace todbench
