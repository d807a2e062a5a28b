// SPDX-License-Identifier: GPL-3.0-or-later
// Alignment of a bench: the present position of the plate in the picture, and the reasons why the set-up cannot be
// measured yet.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "bench/plan/plan.h"
#include "hvs/shape/polygon.h"
#include "tod/presentation/operator_request.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Reasons why a set-up cannot be measured yet, each with its limit.
enum class AlignmentHint {
  not_found,     ///< registration failed
  out_of_focus,  ///< edge blur at least 1.3 times the blur of the sensor description
  tilted,        ///< magnification differs by more than 1 % over the plate or between directions
  near_edge,     ///< an observer's window is partly outside the picture
  drifting,      ///< the plate has moved by more than 0.2 px since the first look
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(AlignmentHint hint);

/// Fault of the alignment, with a sentence for the user.
struct AlignmentRemark {
  AlignmentHint hint = AlignmentHint::not_found;
  std::string sentence;
};

/// A triangle in the picture, in pixels (pixel centres at integers).
struct AlignedTriangle {
  std::string name;
  Polygon outline_px;
  cv::Rect window;  ///< area that the observer judges
};

/// Result of one look at the plate.
struct Alignment {
  std::optional<Registration> registration;  ///< empty: the plate was not found, see remarks
  std::vector<AlignedTriangle> triangles;
  Polygon plate_px;                      ///< the corners of the plate
  double expected_blur_px = 0;           ///< edge blur of the simulated sensor; 0: unknown
  double drift_px = 0;                   ///< drift of the centre of the plate since the first look
  double temporal_noise_k = 0;           ///< temporal noise of a pixel
  std::vector<AlignmentRemark> remarks;  ///< empty: ready to measure
};

/// Callbacks, called from the aligning thread.
struct AlignmentListener {
  std::function<void(std::string_view phase)> on_phase;
  std::function<void(const SourceInfo&)> on_open;
  std::function<void(const Frame&)> on_frame;
  std::function<void(const Alignment&)> on_alignment;
};

/// Evaluates one averaged picture in kelvin. `first`: the registration of the first look, reference of the drift;
/// `sides`: side lengths of the observer's windows, per triangle in order.
[[nodiscard]] Alignment look_at_plate(const cv::Mat1d& kelvin, const TargetPlate& mounted_plate,
                                      const std::vector<int>& sides, const RegistrationOptions& options,
                                      double expected_blur_px, const std::optional<Registration>& first);

/// Shows the first plate of the plan at its highest contrast and evaluates its position repeatedly until stopped. A
/// stop is a success. Errors: those of open_bench(); `disconnected`, `integrity`.
[[nodiscard]] Result<void> align_plan(const Plan& plan, const AlignmentListener& listener, std::stop_token stop);

}  // namespace todbench
