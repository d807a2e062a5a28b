// SPDX-License-Identifier: GPL-3.0-or-later
// Automatic gain of a camera: levels and gain as functions of the scene contrast, and settling time of the level.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/interval.h"
#include "tod/camera_measures/response_measure.h"

namespace todbench {

/// Picture of the first plate at one contrast, after the gain has settled, in counts or in kelvin of the camera's
/// scale.
struct GainLevel {
  double set_delta_t_k = 0, said_delta_t_k = 0;  ///< set-point, and value reported by the target
  double surround = 0;                           ///< median of the plate
  double lowest = 0, highest = 0;                ///< lowest and highest value in the mean picture of the plate
  double contrast = 0, contrast_u = 0;           ///< contrast of the large triangles; u from the scatter over triangles
  int triangles = 0;                             ///< number of large triangles; 0: unknown

  /// Returns the contrast of the picture divided by that of the target, with the 95 % interval from the scatter over
  /// the triangles (Student's t).
  [[nodiscard]] Estimate gain() const;
};

/// Automatic gain: levels by contrast, and settling.
struct GainControlMeasure {
  std::string unit;  ///< "count" or "K"
  int frames = 0;    ///< averaged at each contrast
  std::vector<GainLevel> levels{};
  /// Settling of the level of the surround; empty: not measured, and CameraMeasures::reasons states the reason.
  std::optional<ResponseMeasure> settling{};

  /// Return the levels at the contrasts with the smallest and the largest magnitude. Precondition: there are levels.
  [[nodiscard]] const GainLevel& smallest() const;
  [[nodiscard]] const GainLevel& largest() const;
  /// Returns the gain at the largest contrast divided by the gain at the smallest contrast, with the 95 % interval from
  /// the errors of both gains. A fixed pattern adds the same counts to both contrasts. If the contrasts have different
  /// signs, the pattern increases one gain and decreases the other, so the relative half-widths are added. Otherwise
  /// the result is the root of the sum of their squares.
  [[nodiscard]] Estimate ratio() const;
};

}  // namespace todbench
