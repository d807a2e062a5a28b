// How a scene moves before a camera.
#pragma once

namespace todbench {

/// Angular velocity of the target in the picture, x right, y down. The camera's operator tracks it: the picture shows
/// it where it is, smeared.
struct SceneMotion {
  double x_mrad_s = 0, y_mrad_s = 0;
  bool operator==(const SceneMotion&) const = default;
  [[nodiscard]] bool moving() const { return x_mrad_s != 0 || y_mrad_s != 0; }
};

/// For the effects of a sensor whose scene may begin to move.
inline constexpr SceneMotion any_motion{.x_mrad_s = 1, .y_mrad_s = 0};

}  // namespace todbench
