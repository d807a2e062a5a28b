// SPDX-License-Identifier: GPL-3.0-or-later
// One presentation: requested, reported and observed state of the target.
#pragma once

#include <cstdint>
#include <optional>

#include "tod/presentation/target.h"

namespace todbench {

/// Record of a presentation.
struct Presentation {
  std::int64_t presentation = 0;  ///< index as in Trial; a repeated presentation keeps its number
  TargetState set;                ///< requested state
  PresentedTarget said;           ///< reported state
  /// Effective contrast of the set-up at this set-point, as observed by the camera. Empty: not measured.
  std::optional<double> delta_t_k;
  /// Standard error of `delta_t_k`, from the scatter over the triangles. Empty: fewer than two triangles, or a contrast
  /// in grey levels, which is measured separately in every frame.
  std::optional<double> delta_t_se_k{};
  int reference_triangles = 0;  ///< number of triangles in which the contrast was measured; 0: not stated
  /// Contrast of the smaller triangles in the frames of this presentation. The value contains an unknown constant
  /// factor, which depends on blur and plate. Empty: the contrast was not measured in this presentation.
  std::optional<double> small_delta_t_k{};
  /// Transmittance of the air between target and camera for a contrast; empty: not stated.
  std::optional<double> air_transmittance{};
  /// Requested position of the middle of the plate in the picture, and its position in the frames of this presentation,
  /// in pixels. `seen_error_px` is the larger standard error of x and y. Empty: not checked, or too little contrast.
  std::optional<cv::Point2d> asked_px{}, seen_px{};
  std::optional<double> seen_error_px{};
  /// Time at which the target was in place, on the clock of Trial::host_time_ns. Empty for a simulated scene, which
  /// changes without delay.
  std::optional<std::int64_t> host_time_ns;
  bool operator==(const Presentation&) const = default;
};

}  // namespace todbench
