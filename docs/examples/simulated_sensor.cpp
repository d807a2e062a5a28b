// SPDX-License-Identifier: GPL-3.0-or-later
// A simulated sensor: what it is, what it looks at, one frame.
#include <fmt/core.h>

#include "docs/examples/plate.h"
#include "sim_devices/sensor/sensor_model.h"

using namespace todbench;

int main() {
  SensorSpec spec;  // what is not said has the numbers of an uncooled camera of 320 x 240
  spec.name = "mine";
  spec.width = 160, spec.height = 120;
  spec.pitch_um = 17, spec.detector_um = 15;
  spec.focal_length_mm = 9;
  spec.netd_k = 0.05;
  if (const auto valid = validate(spec); !valid) return fmt::print("{}\n", valid.error().message), 1;
  const SensorModel sensor(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1);
  const PlateScene scene{.plate = example_plate(), .delta_t_k = 2, .distance_m = 1.5};
  const cv::Mat1w counts = sensor.expose(scene, 0);  // exposure 0: the same on every machine
  double low = 0, high = 0;
  cv::minMaxLoc(counts, &low, &high);
  const auto kelvin = [&spec](double count) { return spec.offset_k + spec.kelvin_per_count * count; };
  fmt::print("{} x {} pixels, {:.2f} to {:.2f} K\n", counts.cols, counts.rows, kelvin(low), kelvin(high));
}
