// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of a scene in front of a camera.
#pragma once

namespace todbench {

/// Angular velocity of the target in the picture, x right, y down. The target is tracked: in the picture it is smeared,
/// but at its true position.
struct SceneMotion {
  double x_mrad_s = 0, y_mrad_s = 0;
  bool operator==(const SceneMotion&) const = default;
  [[nodiscard]] bool moving() const { return x_mrad_s != 0 || y_mrad_s != 0; }
};

/// Example of a motion, for the planning of effects for a scene that may start to move.
inline constexpr SceneMotion any_motion{.x_mrad_s = 1, .y_mrad_s = 0};

}  // namespace todbench
