// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement of a plate that a stage moves. A pass consists of several frames. In each frame, a triangle is judged at
// its position in this frame.
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

/// Options of measure_moving().
struct MovingMeasurementOptions {
  /// Options as for a plate at rest; schedule, answers and corrections are ignored.
  MeasurementOptions measurement;
  std::vector<Mounting> mountings;
  /// For each plate of `measurement`, the number of `mountings` in which the plate is shown, counted from the first
  /// mounting; empty: all.
  std::vector<std::size_t> mountings_per_plate{};
  /// Contrasts, not 0. The plate is located at the contrast with the largest magnitude.
  std::vector<double> delta_t_k;
  std::vector<double> speeds_mrad_s;  ///< 0 or more
  /// Number of passes of each plate, mounting, contrast and speed, alternately to the right and to the left.
  int passes = 4;
  int frames = 8;  ///< number of successive frames of a pass that are judged
  /// Number of frames of motion before the first judged frame. It must be large enough that the detector shows no
  /// residue of the plate at rest.
  int lead_frames = 5;
  PlaceSource places = PlaceSource::triangles;
};

/// One pass. The answers of a pass are one cluster.
struct MovingPassRecord {
  int pass = 0;  ///< index in the whole measurement
  /// Index of the sampling phase, counted over plates, mountings and contrasts. The index is the same at every speed.
  int pair = 0;
  std::string plate;
  Mounting mounting = Mounting::identity;
  double set_delta_t_k = 0, delta_t_k = 0;
  double speed_mrad_s = 0;   ///< requested
  double along_x = 1;        ///< +1: to the right
  double said_px_s = 0;      ///< speed reported by the stage, converted by the registration
  double measured_px_s = 0;  ///< speed computed from the positions of the large triangles as a function of device time
  double residual_px = 0;    ///< rms deviation of these positions from a line with the speed of the stage, per axis
  /// Delay of the plate in the picture, from the centre of mass of the large triangles. Empty: the plate is at rest,
  /// there is no trigger, or the contrast is not the largest.
  std::optional<double> lag_s;
  int left_out = 0;     ///< number of triangles whose window is partly outside the picture
  std::string dropped;  ///< reason why the pass has no answers; empty: it has answers
};

/// Answer of one observer to one triangle of a pass.
struct MovingAnswer {
  SequenceObserver observer = SequenceObserver::single_frame;
  double speed_mrad_s = 0;
  Trial trial;  ///< Trial::presentation is MovingPassRecord::pair, with one pass at each speed
};

/// Result of measure_moving().
struct MovingMeasurement {
  std::vector<MovingPassRecord> passes;
  std::vector<MovingAnswer> answers;
  /// Answers to the same frames by the best and by the worst observer of the range of the open parameters, for an
  /// observer with an eye.
  std::array<std::vector<MovingAnswer>, 2> answers_at_ends;
  std::vector<SetUpRecord> set_ups;
  double frame_rate_hz = 0;
  double temporal_noise_k = 0;  ///< temporal noise of a pixel in one frame
  std::map<std::string, std::uint64_t> frames_rejected;
  std::uint64_t frames_lost = 0, frames_used = 0;
  std::optional<Error> ended_by;   ///< reason for an early end; the passes and answers before it are valid
  std::vector<std::string> notes;  ///< includes the notes about the plate at rest: target, contrasts, saturation
  std::vector<Presentation> presentations;  ///< presentations of the contrasts at rest, in the order of the run
  RunConstancy constancy{};                 ///< data from the averages of the plate at rest
};

/// Events of a run, on the measuring thread. Every function may be empty. If a function returns an error, the run ends
/// with this error.
struct MovingListener {
  /// Called when the plate is at rest and its contrast is known, before the passes of this contrast.
  std::function<Result<void>(const Presentation&)> on_presentation{};
  std::function<Result<void>(const MovingAnswer&)> on_answer{};  ///< called for each answer, in the order of the result
  std::function<void(const MovingPassRecord&)> on_pass{};        ///< called after the answers of the pass
};

/// Checks the input of measure_moving() before the camera starts. Errors: `invalid_input` (a target that cannot move,
/// speeds above 5 pixels a frame, displayed samples finer than the detectors, contrasts in grey levels, or a geometry
/// that find_misfits() rejects), `calibration` (no temperature scale).
[[nodiscard]] Result<void> check_moving(const SourceInfo& camera, Target& target, TemplateObserver& observer,
                                        const MovingMeasurementOptions& options);

/// Measures a moving plate. Set-ups are prepared and checked as in measure(). A pass with lost frames or without a
/// located plate is dropped, and its record states the reason. The run ends with `integrity` if at least four passes,
/// and at least a third of the passes made until then, are dropped. A run that ends early after its first answers
/// returns these answers and `ended_by`. Errors: `invalid_input` (a target that cannot move, speeds above 5 pixels a
/// frame, a run longer than the travel of the stage, displayed samples finer than the detectors), those of measure().
[[nodiscard]] Result<MovingMeasurement> measure_moving(FrameSource& source, Target& target, TemplateObserver& observer,
                                                       const MovingMeasurementOptions& options, RunController& host,
                                                       const MovingListener& listener, std::stop_token stop);

}  // namespace todbench
