// SPDX-License-Identifier: GPL-3.0-or-later
// Access to the reference numbers of tests/golden/sensor_reference.json.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>

#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tests/support/source_file.h"

namespace todbench::test {

inline nlohmann::json reference() {
  std::ifstream file(source_file("tests/golden/sensor_reference.json"));
  return nlohmann::json::parse(file);
}

/// The SC2000 as Table 1 of Bijl, Hogervorst and Vos states it.
inline SensorSpec sc2000() {
  SensorSpec spec;
  spec.name = "sc2000";
  return spec;
}

}  // namespace todbench::test
