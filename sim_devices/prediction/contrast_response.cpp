// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/contrast_response.h"

namespace todbench {

Result<double> contrast_response(const SensorModel& model, const TargetPlate& plate, double distance_m,
                                 double min_reference_px, const RegistrationOptions& registration, std::stop_token stop,
                                 LevelEstimate level) {
  // The phases are those of the plate's own triangles, shifted by half a pixel the second time.
  double sum = 0;
  int count = 0;
  for (const Mounting mounting : all_mountings) {
    for (const double phase : {0.0, 0.5}) {
      if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      PlateScene scene;
      scene.plate = mounted(plate, mounting);
      scene.delta_t_k = 1;
      scene.distance_m = distance_m;
      scene.centre_px = {phase, -phase};
      const cv::Mat1d picture = *model.unit_signal(scene);
      auto found = register_plate(picture, scene.plate, registration);
      if (!found) return fail("simulating the contrast of plate " + plate.name, found.error());
      auto contrast = effective_contrast(picture, scene.plate, *found, min_reference_px, level);
      if (!contrast) return fail("simulating the contrast of plate " + plate.name, contrast.error());
      sum += contrast->value;
      ++count;
    }
  }
  return sum / count;
}

}  // namespace todbench
