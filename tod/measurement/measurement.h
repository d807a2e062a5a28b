// SPDX-License-Identifier: GPL-3.0-or-later
// The measurement. It obtains trials from a frame source, a target and an observer. Measurements in the laboratory and
// simulations differ only in these objects.
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

/// Picture in which the contrast of a set-up is measured next. Valid only during the call.
struct SetUpPicture {
  const AveragedPicture& picture;
  int frames = 1;  ///< number of frames averaged
  const TargetPlate& mounted_plate;
  const Registration& registration;  ///< registration in this picture
  const TargetState& state;
};

/// Options of measure().
struct MeasurementOptions {
  double ifov_mrad = 0;             ///< IFOV of one pixel, as the plan states
  double distance_m = 0;            ///< entrance pupil to plate
  std::vector<TargetPlate> plates;  ///< plates in identity mounting
  int registration_frames = 32;     ///< number of frames averaged at the highest contrast to locate the plate
  /// Number of frames averaged to measure the effective contrast, once for each plate, mounting and contrast.
  int contrast_frames = 16;
  double min_reference_px = 4;  ///< size of the smallest triangles that are used to measure the effective contrast
  ContrastUnit contrast_unit = ContrastUnit::kelvin;  ///< grey_levels: the camera's temperature scale is not used
  /// Displayed samples per detector pitch (2: 2x2 microscan); ifov_mrad is then the IFOV of a sample.
  int samples_per_pitch = 1;
  /// JudgedPicture::samples_per_pixel in every frame; ifov_mrad is always the IFOV of a pixel.
  int judged_samples_per_pixel = 1;
  /// Response of effective_contrast() to a contrast of 1 K, by plate name. It is determined with a simulated picture
  /// that includes the blur; 1 if unknown. Measured contrasts are divided by the response.
  std::map<std::string, double> contrast_response;
  /// Called for every SetUpPicture if contrasts are in kelvin. The returned values replace contrast_response for this
  /// and all later pictures. May be empty. Called from the measuring thread.
  std::function<std::map<std::string, double>(const SetUpPicture&)> learn_response{};
  /// Transmittance of the air between target and camera for a contrast, recorded with every presentation. Empty: not
  /// stated.
  std::optional<double> air_transmittance{};
  /// Number of draws of the observer's internal noise for the probabilities of one frame.
  static constexpr int graded_draws = 32;
  AnswerKind answers = AnswerKind::binary;  ///< graded: Trial::probability_correct is also recorded
  int frames_per_presentation = 1;  ///< accepted successive frames over which graded answers are averaged; at least 1
  std::map<double, int> frames_at_contrast;  ///< for each set contrast in the map, replaces frames_per_presentation
  /// Number of exposures discarded after a motion of the target, because they may show the target before the motion.
  int frames_after_change = 2;
  double nuc_interval_s = 0;  ///< interval of commanded non-uniformity corrections; 0: none
  double nuc_wait_s = 1;      ///< frames within this time after a correction are not measured
  /// Largest difference between reported and set contrast of the target. A larger difference adds a note. 0: not
  /// checked.
  double max_readback_deviation_k = 0;
  /// Largest permitted relative deviation of the observed contrast, by set contrast. If the deviation is larger by more
  /// than four standard errors, the run ends with `calibration`. Other contrasts, and contrasts in grey levels, are not
  /// checked.
  std::map<double, double> max_contrast_error{};
  /// Largest permitted distance of the plate from the requested position, for a target that sets positions. If the
  /// distance is larger, the run ends with `calibration`. 0: not checked.
  double max_shift_error_px = 0;
  double max_rejected_share = 0.05;  ///< a larger share, after 100 frames, ends the run with `integrity`
  std::chrono::milliseconds frame_timeout{2000};
  IntegrityOptions integrity;
  RegistrationOptions registration;  ///< the expected scale is computed from distance and IFOV
  std::uint64_t seed = 1;
  bool free_running = true;  ///< true: the camera exposes without requests, so frames are also taken during pauses
};

/// Loss of the camera, after which the run continued with a new segment.
struct Interruption {
  std::int64_t presentation = 0;  ///< first presentation of the new segment
  double away_s = 0;              ///< time from the error to the answers of `presentation`
  double moved_px = 0;            ///< distance between the positions of the plate before and after the loss
  std::string reason;
  bool operator==(const Interruption&) const = default;
};

struct SetUpRecord;

/// Events of a run. The functions are called from the measuring thread. While the measuring thread waits for the
/// target, on_rejected is called from the thread that takes frames, but never from both threads at once. Every function
/// may be empty. No function affects the results. A slow function delays the measurement, but no trials are lost.
struct MeasurementListener {
  std::function<void(const Trial&)> on_trial{};
  /// Called after on_trial with the observer's patch of the first frame. The patch is valid only during the call.
  std::function<void(const Trial&, const Patch&)> on_patch{};
  /// Called for each presentation when the target is in place, before the trials of the presentation, and also if no
  /// trial is possible.
  std::function<void(const Presentation&)> on_presentation{};
  std::function<void(const SetUpRecord&)> on_set_up{};
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
  std::function<void(const std::string& sentence)> on_note{};
  /// Called for every frame that is not used, with the reason.
  std::function<void(const RejectedFrame&)> on_rejected{};
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
  std::vector<ContrastMeasurement> contrasts;    ///< measured contrasts in kelvin, one for each set-up and contrast
  std::vector<JudgedContrast> judged_contrasts;  ///< filled if processing stages follow the camera
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< number of rejected frames by reason
  std::uint64_t frames_lost = 0;                         ///< number of frames missing in the sequence numbers
  /// Temporal noise of a pixel in one frame, from differences of successive frames of one presentation. 0: not
  /// measured.
  double temporal_noise_k = 0;
  std::optional<double> temporal_noise_counts;  ///< temporal noise in steps of the counts, near the surround
  std::optional<double> lag1_correlation;       ///< correlation of a pixel's noise in the same frames
  std::vector<std::string> notes;
  std::vector<Interruption> interruptions;
  std::vector<GreyFrame> grey_frames;  ///< judged frames, if contrasts are in grey levels
  std::optional<Error> ended_by;       ///< reason for an early end; the trials before it are valid
  RunConstancy constancy{};            ///< results of the averages; without a residue if contrasts are in grey levels
};

/// Returns the random stream of the observer's answer to a triangle of a presentation. `triangle`: index in the order
/// of the plate.
[[nodiscard]] RandomStream answer_noise(std::uint64_t seed, std::int64_t presentation, std::size_t triangle);

/// Runs a schedule. Returns an error only if no measurement is possible: the plate is not found, the camera has no
/// temperature scale, or find_misfits() rejects the geometry. A run that ends early returns the trials until then and
/// `ended_by`. `host` and `listener` are used only during the call.
[[nodiscard]] Result<MeasurementResult> measure(FrameSource& source, Target& target, Observer& observer,
                                                TrialSchedule& schedule, const MeasurementOptions& options,
                                                RunController& host, const MeasurementListener& listener,
                                                std::stop_token stop);

}  // namespace todbench
