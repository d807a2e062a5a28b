// Whether a camera's response to the triangles depends on what else is in its field: a hot bar, out and in.
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
#include "bench/enhance/package_file.h"
#include "bench/plan/loaded_plan.h"
#include "bench/run/experiment_host.h"
#include "tod/measurement/measurement.h"

namespace todbench {

enum class SceneDependenceVerdict {
  independent,   ///< every interval lies within the tolerance
  depends,       ///< an interval lies beyond it
  inconclusive,  ///< neither
};
[[nodiscard]] std::string_view to_string(SceneDependenceVerdict verdict);

/// Triangles of one size.
struct SizeDependence {
  double size_mm = 0, size_px = 0;
  int triangles = 0;
  double ratio = 1;  ///< response with the bar in the field over that without
  Interval ci95;     ///< of all sizes together: each at 1 - 0.05 / number of sizes
};

struct SceneDependence {
  std::string camera, package;  ///< the package empty: none
  std::string plate;
  double set_delta_t_k = 0;
  int cycles = 0;
  double tolerance_percent = 0;
  std::vector<SizeDependence> sizes;  ///< largest first
  SceneDependenceVerdict verdict = SceneDependenceVerdict::inconclusive;
  std::vector<std::string> notes;
  SetUpRecord set_up;           ///< where the plate was found
  cv::Mat1d out, in;            ///< the last averages without and with the bar
  double temporal_noise_k = 0;  ///< of a pixel; 0: not measured, or no temperatures
  std::uint64_t frames_used = 0, frames_lost = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
};

struct SceneDependenceOptions {
  int cycles = 6;         ///< 3 or more; each is out, in, in, out, so that a steady drift cancels
  int frames = 16;        ///< averaged each time
  int settle_frames = 0;  ///< left out after the bar has moved, beside those of the plan
  double tolerance_percent = 2;
  /// Before the first frame, when everything is there that has to be; may be empty, an error ends the run.
  std::function<Result<void>(const SourceInfo& camera, const Target& target)> on_begin{};
};

/// Brings the bar into the field or takes it out.
using MoveBar = std::function<Result<void>(bool in, std::stop_token stop)>;

/// The response of a size is the regression of its windows, bar out or in, on those of the picture in which the plate
/// is found, which is the same for both. Errors: those of measure() until the first frame, `calibration` where the
/// plate has moved, `invalid_input` for options out of range.
[[nodiscard]] Result<SceneDependence> measure_scene_dependence(FrameSource& camera, Target& target,
                                                               const MoveBar& move_bar, const TargetState& state,
                                                               Observer& observer, const MeasurementOptions& measuring,
                                                               const SceneDependenceOptions& options,
                                                               MeasurementHost& host, std::stop_token stop);

/// `camera` with `kelvin` more in a bar beside the plate while `*in`: counts of a linear scale, cut off at full scale.
[[nodiscard]] std::unique_ptr<FrameSource> with_hot_bar(std::unique_ptr<FrameSource> camera, cv::Rect bar,
                                                        double kelvin, std::shared_ptr<const bool> in);
/// Left of a plate in the middle of a picture, a twentieth of its width and three fifths of its height. Nothing: there
/// is no room.
[[nodiscard]] std::optional<cv::Rect> place_of_bar(cv::Size picture, const TargetPlate& plate, double px_per_mm);

/// The first plate of the plan in its first mounting at its largest contrast: before its camera, whose operator moves
/// the bar (`host`), or before its simulated sensor with a bar of `bar_k` and the stages of a package (null: none).
/// Errors: as above, of open_bench(); `invalid_input` for a package behind a camera.
[[nodiscard]] Result<SceneDependence> plan_scene_dependence(const LoadedPlan& loaded, const EnhancementPackage* package,
                                                            double bar_k, const SceneDependenceOptions& options,
                                                            const ExperimentHost& host, std::stop_token stop);

}  // namespace todbench
