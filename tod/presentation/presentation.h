// One presentation: what the target was told, what it said, what the camera saw.
#pragma once

#include <cstdint>
#include <optional>

#include "tod/presentation/target.h"

namespace todbench {

struct Presentation {
  std::int64_t presentation = 0;  ///< as in Trial; one that had to be made again has the same number
  TargetState set;                ///< what the target was told
  PresentedTarget said;           ///< what it answered
  /// Effective contrast of the set-up at this set-point, as the camera saw it; nothing: it could not be measured.
  std::optional<double> delta_t_k;
  /// Standard error of that contrast, from the scatter over the triangles it was measured by; nothing: fewer than two
  /// of them, or a contrast in grey levels, where every frame has its own.
  std::optional<double> delta_t_se_k{};
  int reference_triangles = 0;  ///< how many those are; 0: not said
  /// What the air between target and camera leaves of a contrast; nothing: it was not stated.
  std::optional<double> air_transmittance{};
  /// When the target was there, on the clock of Trial::host_time_ns; nothing: a simulated scene, which takes no time.
  std::optional<std::int64_t> host_time_ns;
  bool operator==(const Presentation&) const = default;
};

}  // namespace todbench
