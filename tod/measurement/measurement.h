// SPDX-License-Identifier: GPL-3.0-or-later
// The measurement: produces trials from a frame source, a target and an observer. Laboratory and simulator differ only
// in these objects.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "acquisition/core/frame_source.h"
#include "acquisition/core/integrity_gate.h"
#include "hvs/observer/observer.h"
#include "tod/measurement/contrast_error.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/grey_levels.h"
#include "tod/measurement/judged_contrast.h"
#include "tod/measurement/run_constancy.h"
#include "tod/measurement/run_controller.h"
#include "tod/presentation/presentation.h"
#include "tod/presentation/target.h"
#include "tod/presentation/trial.h"
#include "tod/registration/registration.h"
#include "tod/schedule/schedule.h"

namespace todbench {

/// Picture in which the contrast of a set-up will be measured next. Valid only during the call.
struct SetUpPicture {
  const AveragedPicture& picture;
  int frames = 1;  ///< number of frames averaged
  const TargetPlate& mounted_plate;
  const Registration& registration;  ///< registration in this picture
  const TargetState& state;
};

/// Options of measure().
struct MeasurementOptions {
  double ifov_mrad = 0;             ///< IFOV of one pixel, from the plan
  double distance_m = 0;            ///< entrance pupil to plate
  std::vector<TargetPlate> plates;  ///< plates in identity mounting
  int registration_frames = 32;     ///< number averaged at the highest contrast
  int contrast_frames = 16;     ///< number averaged for the effective contrast, once per plate, mounting and contrast
  double min_reference_px = 4;  ///< smallest triangles that measure the effective contrast
  ContrastUnit contrast_unit = ContrastUnit::kelvin;  ///< grey_levels: the camera's temperature scale is not used
  int samples_per_pitch = 1;  ///< displayed samples per detector pitch (2: 2x2 microscan); the IFOV is that of a sample
  int judged_samples_per_pixel = 1;  ///< value of JudgedPicture in every frame; the IFOV remains that of a pixel
  /// Response of effective_contrast() to a contrast of 1 K, by plate name, from a simulated picture. It includes the
  /// blur; 1 if unknown. Measured contrasts are divided by it.
  std::map<std::string, double> contrast_response;
  /// Called for every SetUpPicture if contrasts are in kelvin. The returned values replace contrast_response from this
  /// picture on. May be empty. Called from the measuring thread.
  std::function<std::map<std::string, double>(const SetUpPicture&)> learn_response{};
  /// Transmittance of the air between target and camera for a contrast. It is recorded with every presentation; empty:
  /// not stated.
  std::optional<double> air_transmittance{};
  static constexpr int graded_draws = 32;   ///< draws of the observer's internal noise for the probabilities of one
                                            ///< frame
  AnswerKind answers = AnswerKind::binary;  ///< graded: also Trial::probability_correct
  int frames_per_presentation = 1;  ///< accepted successive frames over which graded answers are averaged; at least 1
  std::map<double, int> frames_at_contrast;  ///< by set contrast; replaces frames_per_presentation
  int frames_after_change = 2;  ///< exposures discarded after a motion of the target, because they were in transfer
  double nuc_interval_s = 0;    ///< interval of commanded non-uniformity corrections; 0: none
  double nuc_wait_s = 1;        ///< frames within this time after a correction are not measured
  /// Deviation of the target's reported contrast from the set-point above which a note is added; 0: not checked.
  double max_readback_deviation_k = 0;
  /// Largest relative deviation of the observed contrast, by set contrast. If the deviation exceeds it by four standard
  /// errors, the run ends with `calibration`. Other contrasts, and contrasts in grey levels, are not checked.
  std::map<double, double> max_contrast_error{};
  /// Largest distance of the plate from the requested place, if the target sets places. If it is exceeded, the run ends
  /// with `calibration`. 0: not checked.
  double max_shift_error_px = 0;
  double max_rejected_share = 0.05;  ///< a larger share, after 100 frames, ends the run with `integrity`
  std::chrono::milliseconds frame_timeout{2000};
  IntegrityOptions integrity;
  RegistrationOptions registration;  ///< the expected scale is computed from distance and IFOV
  std::uint64_t seed = 1;
  bool free_running = true;  ///< the camera exposes without requests: its frames are also taken during pauses
};

/// A loss of the camera after which the run continued. A new segment begins after it.
struct Interruption {
  std::int64_t presentation = 0;  ///< first presentation of the new segment
  double away_s = 0;              ///< from the error to the answers of that presentation
  double moved_px = 0;            ///< distance between the plate's places before the loss and after it
  std::string reason;
  bool operator==(const Interruption&) const = default;
};

struct SetUpRecord;

/// Events of a run. They are called from the measuring thread. on_rejected is also called from the thread that takes
/// frames while the measuring thread waits for the target, but never from both at once. Every function may be empty,
/// and none affects decisions. A slow listener slows the measurement but loses no trials.
struct MeasurementListener {
  std::function<void(const Trial&)> on_trial{};
  /// Called after on_trial with the observer's patch of the first frame; valid only during the call.
  std::function<void(const Trial&, const Patch&)> on_patch{};
  /// Called when the target is in place, before the trials of the presentation, and also if no trial was possible.
  std::function<void(const Presentation&)> on_presentation{};
  std::function<void(const SetUpRecord&)> on_set_up{};
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
  std::function<void(const std::string& sentence)> on_note{};
  std::function<void(const RejectedFrame&)> on_rejected{};  ///< called for every frame that was not used, with the
                                                            ///< reason
  /// Called when the camera is lost, before the host tries to recover it.
  std::function<void(const Error& why)> on_lost{};
};

/// Registration of one set-up (plate and mounting), for the report.
struct SetUpRecord {
  std::string plate;
  Mounting mounting = Mounting::identity;
  Registration registration;
};

/// Result of measure().
struct MeasurementResult {
  std::vector<Trial> trials;
  std::vector<Presentation> presentations;
  std::vector<SetUpRecord> set_ups;
  std::vector<ContrastMeasurement> contrasts;    ///< in kelvin, one for each set-up and contrast
  std::vector<JudgedContrast> judged_contrasts;  ///< filled if there are stages after the camera
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
  std::uint64_t frames_lost = 0;                         ///< gaps in the sequence
  /// Temporal noise per pixel, from differences of successive frames of one presentation; 0: not measured.
  double temporal_noise_k = 0;
  std::optional<double> temporal_noise_counts;  ///< temporal noise in steps of the counts, near the surround
  std::optional<double> lag1_correlation;       ///< correlation of a pixel's noise in the same frames
  std::vector<std::string> notes;
  std::vector<Interruption> interruptions;
  std::vector<GreyFrame> grey_frames;  ///< judged frames, if contrasts are in grey levels
  std::optional<Error> ended_by;       ///< reason of an early end; the trials so far are valid
  RunConstancy constancy{};            ///< from the averages; no residue for contrasts in grey levels
};

/// Returns the random stream of the observer's answer to a triangle of a presentation. `triangle`: index in the order
/// of the plate.
[[nodiscard]] RandomStream answer_noise(std::uint64_t seed, std::int64_t presentation, std::size_t triangle);

/// Runs a schedule. Fails only if no measurement was possible (plate not found, uncalibrated camera, sizes that do not
/// fit). A run that ended early returns its trials with `ended_by`. `host` and `listener` are used only during the
/// call.
[[nodiscard]] Result<MeasurementResult> measure(FrameSource& source, Target& target, Observer& observer,
                                                TrialSchedule& schedule, const MeasurementOptions& options,
                                                RunController& host, const MeasurementListener& listener,
                                                std::stop_token stop);

}  // namespace todbench
