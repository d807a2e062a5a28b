// Targets as a few prisms: their views from any side are polygons of a scene.
#pragma once

#include <string>
#include <vector>

#include "sim_devices/scene/field_scene.h"

namespace todbench {

/// An outline in the plane of length and height, drawn out across it.
struct TargetPart {
  std::string name;
  Polygon profile_m;  ///< x forward, y up from the ground or water
  double width_m = 0;
  double side_m = 0;  ///< of its middle, to port
  double temperature_k = 300, emissivity = 0.95;
};

struct TargetModel {
  std::string name, description;
  std::vector<TargetPart> parts;
};

/// `invalid_input` in one sentence, as validate(FieldScene).
[[nodiscard]] Result<void> validate(const TargetModel& model);

/// What is seen from far away at the height of the target: 0 degrees from ahead, 90 from its right side (its front is
/// at the right of the picture), 180 from behind. Faces turned to the viewer, the far ones first; x right, y down,
/// origin where the model has it. All are targets.
[[nodiscard]] std::vector<SceneRegion> view_of(const TargetModel& model, double azimuth_deg);

}  // namespace todbench
