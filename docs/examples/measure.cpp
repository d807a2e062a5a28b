// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the TOD of a camera. The camera here is a simulated one; any FrameSource takes its place, and any Target
// that of the scene.
#include <fmt/core.h>

#include "docs/examples/plate.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

using namespace todbench;

int main() {
  const TargetPlate plate = example_plate();
  SensorSpec spec;  // 320 x 240, 1.31 mrad, 70 mK
  spec.name = "mine";
  const auto model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), 1);
  const auto scene = std::make_shared<SceneHolder>(PlateScene{.plate = plate, .distance_m = 2});
  const auto camera = simulated_source(model, scene, "1");
  const auto target = scene_target(scene, {plate});
  TemplateObserver observer({}, triangle_alternatives());

  MeasurementOptions options;
  options.ifov_mrad = spec.ifov_mrad();
  options.distance_m = 2;
  options.plates = {plate};
  ListedSchedule schedule(constant_stimuli({.plates = {plate.name},
                                            .drawings = {plate},
                                            .mountings = {Mounting::identity, Mounting::rotated_180},
                                            .delta_t_k = {2},
                                            .phases = 8,
                                            .pixel_mm = 2 * spec.ifov_mrad()},
                                           RandomStream(1, "schedule")));
  UnattendedHost host;
  const auto measured = measure(*camera, *target, observer, schedule, options, host, {}, {});
  const auto curve = measured ? tod_curve(measured->trials, {}) : tl::unexpected(measured.error());
  if (!curve) return fmt::print("{}\n", curve.error().message), 1;
  if (!curve->points.front().fit.usable()) return fmt::print("no threshold\n"), 3;
  const PsychometricFit& fit = curve->points.front().fit;
  fmt::print("S75 {:.3f} mrad, 95 % {:.3f} to {:.3f}, {} trials\n", *fit.threshold, *fit.ci95.low, *fit.ci95.high,
             fit.trials);
}
