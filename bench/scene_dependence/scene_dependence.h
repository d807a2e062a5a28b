// SPDX-License-Identifier: GPL-3.0-or-later
// Test whether the response of a camera to the triangles depends on the rest of its field. A hot bar is outside or
// inside the field.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "bench/devices/experiment_host.h"
#include "bench/enhance/package_file.h"
#include "bench/plan/loaded_plan.h"
#include "tod/measurement/measurement.h"

namespace todbench {

/// Result of the test.
enum class SceneDependenceVerdict {
  independent,   ///< all intervals lie within the tolerance
  depends,       ///< an interval lies outside the tolerance
  inconclusive,  ///< an interval lies partly outside the tolerance, and none completely
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(SceneDependenceVerdict verdict);

/// Result for triangles of one size.
struct SizeDependence {
  double size_mm = 0, size_px = 0;
  int triangles = 0;
  double ratio = 1;  ///< response with the bar in the field divided by the response without the bar
  Interval ci95;     ///< simultaneous for all sizes: each at 1 - 0.05 / number of sizes
};

/// Result of the measurement.
struct SceneDependence {
  std::string camera, package;  ///< an empty package: none
  std::string plate;
  double set_delta_t_k = 0;
  int cycles = 0;
  double tolerance_percent = 0;
  std::vector<SizeDependence> sizes;  ///< largest first
  SceneDependenceVerdict verdict = SceneDependenceVerdict::inconclusive;
  std::vector<std::string> notes;
  SetUpRecord set_up;           ///< position of the plate
  cv::Mat1d out, in;            ///< last average pictures without and with the bar
  double temporal_noise_k = 0;  ///< temporal noise of a pixel; 0: not measured, or no temperatures
  std::uint64_t frames_used = 0, frames_lost = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
};

/// Options of the measurement.
struct SceneDependenceOptions {
  int cycles = 6;         ///< cycles, at least 3; the bar is out, in, in, out in each cycle, so that a linear drift
                          ///< cancels
  int frames = 16;        ///< frames averaged per position of the bar
  int settle_frames = 0;  ///< frames discarded after the bar has moved, in addition to the number in the plan
  double tolerance_percent = 2;  ///< largest allowed change of the response
  /// Function called before the first frame, when all parts are ready. An error ends the run. Optional.
  std::function<Result<void>(const SourceInfo& camera, const Target& target)> on_begin{};
};

/// Function that moves the bar into the field or out of it.
using MoveBar = std::function<Result<void>(bool in, std::stop_token stop)>;

/// Measures the dependence. The response of a size is the regression slope of the windows around its triangles on the
/// same windows of a reference picture. The reference is the picture in which the plate was located. The same reference
/// is used with the bar outside and inside. Errors: those of measure() until the first frame, `calibration` if the
/// plate has moved, `invalid_input` for options out of range.
[[nodiscard]] Result<SceneDependence> measure_scene_dependence(FrameSource& camera, Target& target,
                                                               const MoveBar& move_bar, const TargetState& state,
                                                               Observer& observer, const MeasurementOptions& measuring,
                                                               const SceneDependenceOptions& options,
                                                               RunController& host, std::stop_token stop);

/// Returns a camera that passes on the frames of `camera` and adds `kelvin` to `bar` while `*in` is true. The counts
/// have a linear scale and are clipped at full scale.
[[nodiscard]] std::unique_ptr<FrameSource> with_hot_bar(std::unique_ptr<FrameSource> camera, cv::Rect bar,
                                                        double kelvin, std::shared_ptr<const bool> in);
/// Returns the position of the bar: left of a plate in the centre of the picture. The bar has 1/20 of the picture's
/// width and 3/5 of its height. Empty: too little room.
[[nodiscard]] std::optional<cv::Rect> place_of_bar(cv::Size picture, const TargetPlate& plate, double px_per_mm);

/// Measures the first plate of the plan in its first mounting at its largest contrast. With the camera of the plan, the
/// operator moves the bar (`host`). With the simulated sensor, the bar has a contrast of `bar_k`, and the stages of a
/// package follow (null: none). Errors: those of measure_scene_dependence(), those of open_bench(); `invalid_input` for
/// a package applied to a real camera.
[[nodiscard]] Result<SceneDependence> plan_scene_dependence(const LoadedPlan& loaded, const EnhancementPackage* package,
                                                            double bar_k, const SceneDependenceOptions& options,
                                                            const ExperimentHost& host, std::stop_token stop);

}  // namespace todbench
