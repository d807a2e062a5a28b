// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of a scene in front of a camera.
#pragma once

namespace todbench {

/// Angular velocity of the target in the picture, x to the right, y downwards. The motion smears the picture of the
/// target. The smeared picture is centred on the true position of the target, as for an observer that tracks the
/// target.
struct SceneMotion {
  double x_mrad_s = 0, y_mrad_s = 0;
  bool operator==(const SceneMotion&) const = default;
  [[nodiscard]] bool moving() const { return x_mrad_s != 0 || y_mrad_s != 0; }
};

/// An arbitrary motion. Pass it to full_plan() if the target may start to move, so that the effects of motion are
/// simulated.
inline constexpr SceneMotion any_motion{.x_mrad_s = 1, .y_mrad_s = 0};

}  // namespace todbench
