// SPDX-License-Identifier: GPL-3.0-or-later
// Target models made of a few prisms. The view of a model from any side is a set of polygons of a scene.
#pragma once

#include <string>
#include <vector>

#include "sim_devices/scene/field_scene.h"

namespace todbench {

/// Prism: an outline in the plane of length and height, extruded perpendicular to this plane.
struct TargetPart {
  std::string name;
  Polygon profile_m;  ///< x forward, y up from the ground or water
  double width_m = 0;
  double side_m = 0;                              ///< lateral position of the middle of the prism; positive to port
  double temperature_k = 300, emissivity = 0.95;  ///< of all surfaces of the prism
};

/// Target made of parts.
struct TargetModel {
  std::string name, description;
  std::vector<TargetPart> parts;
};

/// Checks a model. Errors: `invalid_input`, as validate(FieldScene).
[[nodiscard]] Result<void> validate(const TargetModel& model);

/// Returns the view from far away at the height of the target. Azimuth 0 degrees is from ahead, 90 from its right side
/// (its front is at the right of the picture), 180 from behind. The view consists of the faces turned to the viewer,
/// far faces first; x right, y down, with the origin of the model. All faces are marked as target.
[[nodiscard]] std::vector<SceneRegion> view_of(const TargetModel& model, double azimuth_deg);

}  // namespace todbench
