// The measurement before a plate that a stage moves: passes of several frames, each triangle judged where it is.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "tod/measurement/measurement.h"
#include "tod/measurement/place_source.h"
#include "tod/measurement/sequence_judge.h"

namespace todbench {

struct MovingMeasurementOptions {
  /// As for a plate at rest; schedule, answers and corrections are not looked at.
  MeasurementOptions measurement;
  std::vector<Mounting> mountings;
  std::vector<double> delta_t_k;      ///< not 0; the plate is registered at the largest
  std::vector<double> speeds_mrad_s;  ///< 0 or more
  int passes = 4;       ///< of every plate, mounting, contrast and speed, to the right and to the left in turn
  int frames = 8;       ///< of a pass, successive
  int lead_frames = 5;  ///< of motion before the first, until the detector has forgotten the plate at rest
  PlaceSource places = PlaceSource::triangles;
};

/// One pass. Clusters of answers are passes.
struct MovingPassRecord {
  int pass = 0;  ///< over the whole measurement
  int pair = 0;  ///< counts sampling phases of plates, mountings and contrasts: the same at every speed
  std::string plate;
  Mounting mounting = Mounting::identity;
  double set_delta_t_k = 0, delta_t_k = 0;
  double speed_mrad_s = 0;   ///< as asked for
  double along_x = 1;        ///< +1: to the right
  double said_px_s = 0;      ///< what the stage said, through the registration
  double measured_px_s = 0;  ///< slope of the places of the large triangles over device time
  double residual_px = 0;    ///< rms of those places from the line at the stage's speed, per axis
  /// How late the picture shows the plate, by the centre of mass of the large triangles; nothing: at rest, no trigger,
  /// or not the largest contrast.
  std::optional<double> lag_s;
  int left_out = 0;     ///< triangles whose window leaves the picture
  std::string dropped;  ///< why there are no answers; empty: there are
};

struct MovingAnswer {
  SequenceObserver observer = SequenceObserver::single_frame;
  double speed_mrad_s = 0;
  Trial trial;  ///< presentation: MovingPassRecord::pair, one pass at each speed
};

struct MovingMeasurement {
  std::vector<MovingPassRecord> passes;
  std::vector<MovingAnswer> answers;
  std::vector<SetUpRecord> set_ups;
  double frame_rate_hz = 0;
  double temporal_noise_k = 0;  ///< per pixel and frame
  std::map<std::string, std::uint64_t> frames_rejected;
  std::uint64_t frames_lost = 0, frames_used = 0;
  std::optional<Error> ended_by;   ///< why it stopped early; passes and answers so far are valid
  std::vector<std::string> notes;  ///< those of a plate at rest, too: what the target says, contrasts, saturation
  std::vector<Presentation> presentations;  ///< of the contrasts at rest, in the order of the run
};

/// What the run says while it goes on, on the measuring thread. Every function may be empty; an error of one ends the
/// run with it.
struct MovingListener {
  /// The plate was there at rest and its contrast is known; before the passes of this contrast.
  std::function<Result<void>(const Presentation&)> on_presentation{};
  std::function<Result<void>(const MovingAnswer&)> on_answer{};  ///< each at once, in the order of the result
  std::function<void(const MovingPassRecord&)> on_pass{};        ///< after its answers
};

/// What measure_moving() refuses before it starts the camera: `invalid_input` (a target that cannot run, speeds beyond
/// 5 pixels a frame, displayed samples finer than the detectors, contrasts in grey levels, sizes that do not fit),
/// `calibration` (no temperature scale).
[[nodiscard]] Result<void> check_moving(const SourceInfo& camera, Target& target, TemplateObserver& observer,
                                        const MovingMeasurementOptions& options);

/// Set-ups are looked at as in measure(), with its checks. Errors: `invalid_input` (a target that cannot run, speeds
/// beyond 5 pixels a frame, runs beyond the stage, displayed samples finer than the detectors), those of measure(). A
/// pass whose frames were lost or whose plate was not found is dropped, and its record says why; when a third of them
/// and more are, the run ends with `integrity`. A run that ended early after its first answers returns them with
/// `ended_by`.
[[nodiscard]] Result<MovingMeasurement> measure_moving(FrameSource& source, Target& target, TemplateObserver& observer,
                                                       const MovingMeasurementOptions& options, MeasurementHost& host,
                                                       const MovingListener& listener, std::stop_token stop);

}  // namespace todbench
