// Setting up a bench: where the plate is in the picture now, and what is wrong with that.
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

/// What stands between a set-up and a measurement, each with the number that decides.
enum class AlignmentHint {
  not_found,     ///< registration failed
  out_of_focus,  ///< edges are blurred 1.3 times as much as the sensor description says, or more
  tilted,        ///< magnification differs by more than 1 % over the plate or between directions
  near_edge,     ///< a window leaves the picture
  drifting,      ///< the plate has moved by more than 0.2 px since the first look
};
[[nodiscard]] std::string_view to_string(AlignmentHint hint);

struct AlignmentRemark {
  AlignmentHint hint = AlignmentHint::not_found;
  std::string sentence;
};

/// A triangle in the picture, in pixels (pixel centres at integers).
struct AlignedTriangle {
  std::string name;
  Polygon outline_px;
  cv::Rect window;  ///< what the observer will see
};

/// One look.
struct Alignment {
  std::optional<Registration> registration;  ///< nothing: see remarks
  std::vector<AlignedTriangle> triangles;
  Polygon plate_px;                      ///< the corners of the plate
  double expected_blur_px = 0;           ///< of the simulated sensor; 0: not known
  double drift_px = 0;                   ///< of the plate's middle since the first look
  double temporal_noise_k = 0;           ///< per pixel
  std::vector<AlignmentRemark> remarks;  ///< none: ready to measure
};

/// Called from the aligning thread.
struct AlignmentListener {
  std::function<void(std::string_view phase)> on_phase;
  std::function<void(const SourceInfo&)> on_open;
  std::function<void(const Frame&)> on_frame;
  std::function<void(const Alignment&)> on_alignment;
};

/// What one averaged picture (kelvin) says. `first`: the registration of the first look, to see drift; `sides`: of the
/// observer's windows, per triangle in order.
[[nodiscard]] Alignment look_at_plate(const cv::Mat1d& kelvin, const TargetPlate& mounted_plate,
                                      const std::vector<int>& sides, const RegistrationOptions& options,
                                      double expected_blur_px, const std::optional<Registration>& first);

/// Shows the first plate of the plan at its highest contrast and looks at it again and again until stopped, which is
/// success. Errors: as open_bench(); `disconnected`, `integrity`.
[[nodiscard]] Result<void> align_plan(const Plan& plan, const AlignmentListener& listener, std::stop_token stop);

}  // namespace todbench
