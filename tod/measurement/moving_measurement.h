// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement of a plate that a stage moves: passes of several frames, each triangle judged at its place.
#pragma once

#include <array>
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
  /// As for a plate at rest; schedule, answers and corrections are ignored.
  MeasurementOptions measurement;
  std::vector<Mounting> mountings;
  /// Number of `mountings`, the first ones, that show each plate of `measurement`; empty: all of them.
  std::vector<std::size_t> mountings_per_plate{};
  std::vector<double> delta_t_k;      ///< not 0; the plate is registered at the largest
  std::vector<double> speeds_mrad_s;  ///< 0 or more
  int passes = 4;                     ///< of every plate, mounting, contrast and speed, right and left in turn
  int frames = 8;                     ///< of a pass, successive
  int lead_frames = 5;  ///< of motion before the first, until the detector has forgotten the plate at rest
  PlaceSource places = PlaceSource::triangles;
};

/// One pass. Passes are the clusters of answers.
struct MovingPassRecord {
  int pass = 0;  ///< over the whole measurement
  int pair = 0;  ///< counts sampling phases of plates, mountings and contrasts: the same at every speed
  std::string plate;
  Mounting mounting = Mounting::identity;
  double set_delta_t_k = 0, delta_t_k = 0;
  double speed_mrad_s = 0;   ///< requested
  double along_x = 1;        ///< +1: to the right
  double said_px_s = 0;      ///< speed reported by the stage, converted by the registration
  double measured_px_s = 0;  ///< slope of the places of the large triangles over device time
  double residual_px = 0;    ///< rms of those places from the line at the stage's speed, per axis
  /// Delay of the plate in the picture, by the centre of mass of the large triangles; empty: at rest, no trigger, or
  /// not the largest contrast.
  std::optional<double> lag_s;
  int left_out = 0;     ///< triangles whose window leaves the picture
  std::string dropped;  ///< reason why there are no answers; empty: there are
};

struct MovingAnswer {
  SequenceObserver observer = SequenceObserver::single_frame;
  double speed_mrad_s = 0;
  Trial trial;  ///< presentation: MovingPassRecord::pair, one pass at each speed
};

struct MovingMeasurement {
  std::vector<MovingPassRecord> passes;
  std::vector<MovingAnswer> answers;
  /// Of an observer with an eye: answers at the best and the worst end of its open parameters, to the same frames.
  std::array<std::vector<MovingAnswer>, 2> answers_at_ends;
  std::vector<SetUpRecord> set_ups;
  double frame_rate_hz = 0;
  double temporal_noise_k = 0;  ///< per pixel and frame
  std::map<std::string, std::uint64_t> frames_rejected;
  std::uint64_t frames_lost = 0, frames_used = 0;
  std::optional<Error> ended_by;            ///< reason of an early end; passes and answers so far are valid
  std::vector<std::string> notes;           ///< includes those of a plate at rest: target, contrasts, saturation
  std::vector<Presentation> presentations;  ///< of the contrasts at rest, in the order of the run
  RunConstancy constancy{};                 ///< of the averages of a plate at rest
};

/// Events of a run, on the measuring thread. Every function may be empty. An error returned by one ends the run with
/// this error.
struct MovingListener {
  /// The plate is at rest and its contrast is known; before the passes of this contrast.
  std::function<Result<void>(const Presentation&)> on_presentation{};
  std::function<Result<void>(const MovingAnswer&)> on_answer{};  ///< one by one, in the order of the result
  std::function<void(const MovingPassRecord&)> on_pass{};        ///< after its answers
};

/// Checks of measure_moving() before it starts the camera. Errors: `invalid_input` (a target that cannot run, speeds
/// above 5 pixels a frame, displayed samples finer than the detectors, contrasts in grey levels, sizes that do not
/// fit), `calibration` (no temperature scale).
[[nodiscard]] Result<void> check_moving(const SourceInfo& camera, Target& target, TemplateObserver& observer,
                                        const MovingMeasurementOptions& options);

/// Treats set-ups as measure(), with its checks. A pass with lost frames or without a located plate is dropped, and its
/// record states why; if at least a third are dropped, the run ends with `integrity`. A run that ended early after its
/// first answers returns them with `ended_by`. Errors: `invalid_input` (a target that cannot run, speeds above 5 pixels
/// a frame, runs beyond the stage, displayed samples finer than the detectors), those of measure().
[[nodiscard]] Result<MovingMeasurement> measure_moving(FrameSource& source, Target& target, TemplateObserver& observer,
                                                       const MovingMeasurementOptions& options, RunController& host,
                                                       const MovingListener& listener, std::stop_token stop);

}  // namespace todbench
