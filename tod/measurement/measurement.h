// The measurement: frame source, target and observer in, trials out. The laboratory and the simulator differ only in
// these objects.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "acquisition/core/integrity_gate.h"
#include "hvs/observer/observer.h"
#include "tod/measurement/contrast_error.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/grey_levels.h"
#include "tod/measurement/measurement_host.h"
#include "tod/presentation/presentation.h"
#include "tod/presentation/target.h"
#include "tod/presentation/trial.h"
#include "tod/registration/registration.h"
#include "tod/schedule/schedule.h"

namespace todbench {

struct MeasurementOptions {
  double ifov_mrad = 0;             ///< of one pixel, from the plan
  double distance_m = 0;            ///< entrance pupil to plate
  std::vector<TargetPlate> plates;  ///< in identity mounting
  int registration_frames = 32;     ///< averaged at the highest contrast
  int contrast_frames = 16;         ///< averaged for the effective contrast, once per plate, mounting and contrast
  double min_reference_px = 4;      ///< triangles from this size measure the effective contrast
  ContrastUnit contrast_unit = ContrastUnit::kelvin;  ///< grey levels: the temperature scale of the camera is not used
  int samples_per_pitch = 1;  ///< displayed samples per detector pitch (2: 2x2 microscan); the IFOV is that of a sample
  int judged_samples_per_pixel = 1;  ///< of JudgedPicture, in every frame; the IFOV stays that of a pixel
  /// By plate name: what effective_contrast() reads of a contrast of 1 K, blur included, from a simulated picture; 1
  /// where it is not known. Measured contrasts are divided by it.
  std::map<std::string, double> contrast_response;
  /// What the air between target and camera leaves of a contrast, kept with every presentation; nothing: not stated.
  std::optional<double> air_transmittance{};
  static constexpr int graded_draws = 32;   ///< of the observer's own noise, for the probabilities of one frame
  AnswerKind answers = AnswerKind::binary;  ///< graded: Trial::probability_correct too
  int frames_per_presentation = 1;          ///< successive good ones, over which graded answers are averaged; 1 or more
  std::map<double, int> frames_at_contrast;  ///< by set contrast, where there is another number of them
  int frames_after_change = 2;               ///< exposures discarded after the target moved (frames in flight)
  double nuc_interval_s = 0;                 ///< correct the camera's non-uniformity this often; 0: never commanded
  double nuc_wait_s = 1;                     ///< frames within this time after a correction are not measured
  /// Beyond it, what the target says it shows is a note beside what it was told; 0: what it says is not looked at.
  double max_readback_deviation_k = 0;
  double max_rejected_share = 0.05;  ///< beyond it, after 100 frames, the run ends with `integrity`
  std::chrono::milliseconds frame_timeout{2000};
  IntegrityOptions integrity;
  RegistrationOptions registration;  ///< expected scale is filled in from distance and IFOV
  std::uint64_t seed = 1;
  bool free_running = true;  ///< the camera exposes whether its frames are taken or not: they are taken in a pause too
};

/// A loss of the camera that the run survived. Begins a new segment.
struct Interruption {
  std::int64_t presentation = 0;  ///< the first one of the new segment
  double away_s = 0;              ///< from the error to the answers of that presentation
  double moved_px = 0;            ///< where the plate was found again, from where it had been
  std::string reason;
  bool operator==(const Interruption&) const = default;
};

struct SetUpRecord;

/// What the run says while it goes on. Called from the measuring thread, but on_rejected also from the one that takes
/// frames while the measuring thread waits for the target: never two at once. Every function may be empty; none decides
/// anything. A slow listener slows the measurement, it never loses trials.
struct MeasurementListener {
  std::function<void(const Trial&)> on_trial{};
  /// After on_trial: what the observer saw in the first frame; lent for the call.
  std::function<void(const Trial&, const Patch&)> on_patch{};
  /// The target was there; before the trials of the presentation, and also when none could be made.
  std::function<void(const Presentation&)> on_presentation{};
  std::function<void(const SetUpRecord&)> on_set_up{};
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
  std::function<void(const std::string& sentence)> on_note{};
  std::function<void(const RejectedFrame&)> on_rejected{};  ///< every frame that was not used, with the reason
  /// The camera was lost, and the host is about to bring it back.
  std::function<void(const Error& why)> on_lost{};
};

/// Registration and contrast of one set-up (plate and mounting), for the report.
struct SetUpRecord {
  std::string plate;
  Mounting mounting = Mounting::identity;
  Registration registration;
};

struct MeasurementResult {
  std::vector<Trial> trials;
  std::vector<Presentation> presentations;
  std::vector<SetUpRecord> set_ups;
  std::vector<ContrastMeasurement> contrasts;  ///< in kelvin, one for each set-up and contrast
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
  std::uint64_t frames_lost = 0;                         ///< gaps in the sequence
  double temporal_noise_k =
      0;  ///< per pixel, from differences of successive frames of the same presentation; 0: not measured
  std::optional<double> temporal_noise_counts;  ///< the same in steps of the counts, near the surround
  std::optional<double> lag1_correlation;       ///< of a pixel's noise in the same frames
  std::vector<std::string> notes;
  std::vector<Interruption> interruptions;
  std::vector<GreyFrame> grey_frames;  ///< those that were judged, where contrasts are in grey levels
  std::optional<Error> ended_by;       ///< why it stopped early; the trials so far are valid
};

/// Runs a schedule. Fails only when nothing could be measured (plate not found, uncalibrated camera, sizes that do not
/// fit); a run that ended early returns its trials with `ended_by`. `host` and `listener` are lent for the call.
[[nodiscard]] Result<MeasurementResult> measure(FrameSource& source, Target& target, Observer& observer,
                                                TrialSchedule& schedule, const MeasurementOptions& options,
                                                MeasurementHost& host, const MeasurementListener& listener,
                                                std::stop_token stop);

}  // namespace todbench
