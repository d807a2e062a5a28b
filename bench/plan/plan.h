// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement plan: equipment, conditions, duration and limits. A value type; the file format is TOML.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "acquisition/base/result.h"
#include "bench/plan/budget_row.h"
#include "bench/plan/conformity_rule.h"
#include "bench/plan/order.h"
#include "bench/plan/resources.h"
#include "hvs/eye/viewed_display.h"
#include "sim_devices/module/module_plan.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/camera_measures/camera_measures.h"
#include "tod/measurement/measurement.h"
#include "tod/measurement/place_source.h"
#include "tod/plate/target_plate.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/schedule/schedule.h"

namespace todbench {

/// [camera] warm_up: condition that the camera meets before a run. The defaults state no condition.
struct WarmUpPlan {
  double time_s = 0;           ///< frames are taken for this time before the run
  double drift_k_per_min = 0;  ///< the drift of the frame mean must be below this; 0: not checked
  double window_s = 60;        ///< duration of the frames from which the drift is computed
  double timeout_s = 3600;     ///< the run ends if the drift is not below its limit after this time
  /// Returns whether the run waits.
  [[nodiscard]] bool stated() const { return time_s > 0 || drift_k_per_min > 0; }
  bool operator==(const WarmUpPlan&) const = default;
};

/// [camera]: the real or emulated camera. Without an id the plan can only be simulated.
struct CameraPlan {
  std::string id;             ///< as listed by `todbench devices`, e.g. "gige:FLIR-48000123"
  double ifov_mrad = 0;       ///< field of view of one pixel along x; required with an id
  double pixel_aspect = 1;    ///< height over width of a pixel; without the key, LoadedPlan uses the sensor's value
  double nuc_interval_s = 0;  ///< period of commanded corrections; 0: never commanded
  double nuc_wait_s = 1;      ///< frames within this time after a correction are not measured
  std::map<std::string, std::string> settings;   ///< feature -> value; set before the run and read back
  double reconnect_s = 60;                       ///< maximum time to wait for a lost camera; 0: no reconnection
  ContrastUnit contrast = ContrastUnit::kelvin;  ///< camera only; the twin is measured in kelvin
  std::string frame_size;                        ///< "640x512": requested size; empty: chosen by the back end
  std::string nuc_command;                       ///< feature that triggers a correction; empty: found by name
  WarmUpPlan warm_up{};
  bool operator==(const CameraPlan&) const = default;
};

/// Kind of target.
enum class TargetKind {
  scpi,    ///< black body and plate stage on the network
  prompt,  ///< the operator changes the target on request
  scene,   ///< the simulated scene of a simulated or emulated camera
  display  ///< a monitor on which the bench draws
};
inline constexpr std::array all_target_kinds{TargetKind::scpi, TargetKind::prompt, TargetKind::scene,
                                             TargetKind::display};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(TargetKind kind);

/// [target] collimator: a mirror or lens that shows the plate at infinity. The collimator replaces the distance.
struct CollimatorPlan {
  double focal_length_mm = 0;    ///< 0: no collimator
  double focal_length_u_mm = 0;  ///< standard uncertainty
  /// Transmission of a contrast. In a loaded plan with a table: the mean of the table over the band.
  double transmission = 1;
  double transmission_u = 0;  ///< standard uncertainty
  /// Table of the transmission: wavelengths in rising order, and the transmission at each. Empty: no table.
  std::vector<double> wavelengths_um{}, transmissions{};
  /// Temperature of the mirrors; empty: temperature of the air.
  std::optional<double> mirror_temperature_c{};
  double blur_mrad = 0;  ///< aberration: standard deviation of a normal blur per axis
  /// Returns whether the plan has a collimator.
  [[nodiscard]] bool stated() const { return focal_length_mm > 0; }
  bool operator==(const CollimatorPlan&) const = default;
};

/// Section [target]. Every combination of its lists is shown.
struct TargetPlan {
  TargetKind kind = TargetKind::scene;
  std::string black_body;  ///< address of the instrument; required for kind scpi
  std::string stage;       ///< address of the stage that moves the plate; required for kind scpi
  std::string black_body_table = "scpi-black-body";  ///< command table: name or file
  std::string stage_table = "scpi-stage";
  /// Kind display: program that shows pictures, size of the picture, contrast of black and white on the screen (K of
  /// the camera's scale), exponent of luminance as a function of level, and settling time of the panel.
  std::string display = "todbench-gui --pictures";
  int display_width_px = 1920, display_height_px = 1080;
  double display_pixel_mm = 0, display_span_k = 0, display_gamma = 1, display_settle_s = 0.2;
  /// Luminance at equally spaced levels, black to white; replaces display_gamma.
  std::vector<double> display_luminance{0, 1};
  /// Distance from the entrance pupil to the plate, or the focal length of the collimator. A file states either this
  /// distance or a collimator.
  double distance_m = 2;
  CollimatorPlan collimator{};
  std::vector<std::string> plates{"tcat-a", "tcat-b"};  ///< names or files
  std::vector<Mounting> mountings{all_mountings.begin(), all_mountings.end()};
  /// Number of `mountings` in which a plate is shown, counted from the first: one number for all plates, or one for
  /// each of `plates` in its order; 0: all.
  std::vector<int> mountings_per_plate{0};
  std::vector<double> delta_t_k{16.9, 1.93, 0.23};  ///< set contrasts, never 0; the sign is the polarity
  int phases = 16;                                  ///< sub-pixel shifts per plate, mounting and contrast
  /// Largest error of an observed shift of the plate; a larger error ends the run. 0: shifts are not checked.
  double max_shift_error_px = 0.25;
  /// Air between plate and camera; humidity 0: not stated, no correction.
  double air_temperature_c = 20, air_humidity_percent = 0;
  double settle_timeout_s = 600;  ///< the run ends if the target is not stable after this time
  /// Largest deviation of the effective contrast from the set contrast; empty: derived from the budget
  /// (allowed_contrast_deviation()).
  std::optional<double> max_contrast_deviation_percent{};
  /// Percentage of the set contrast within which a presentation begins; its contrast is then measured from its own
  /// frames. 0: the target must settle first.
  double contrast_settling_band_percent = 0;
  /// Largest time by which the contrast in the middle of the plate lags behind the contrast at the large triangles;
  /// required for a ramp. Empty: not stated.
  std::optional<double> max_contrast_lag_s{};
  /// Durations of changes of the target; the order of presentations follows from them.
  double plate_change_s = 60, mounting_change_s = 30, contrast_change_s = 20, shift_change_s = 0.1;
  bool operator==(const TargetPlan&) const = default;
};

/// Returns the number of mountings in which the plate of this index is shown.
[[nodiscard]] std::size_t mountings_of(const TargetPlan& target, std::size_t plate);
/// Returns the number of set-ups: plates in their mountings.
[[nodiscard]] std::size_t set_ups_of(const TargetPlan& target);

/// Section [simulation]: the twin.
struct SimulationPlan {
  std::string sensor = "sc2000";    ///< name or file
  std::string accuracy = "normal";  ///< draft, normal, reference, or auto (from tolerance_percent alone)
  double tolerance_percent = 1;     ///< allowed numerical error of the 75 % acuity
  int microscan = 1;                ///< samples per pitch and axis; replaces the value of the sensor file
  int phases = 16;                  ///< sub-pixel shifts per plate, mounting and contrast of the twin
  SceneMotion motion{};             ///< motion of the target, which acts through time constant, exposure and readout
  std::vector<Effect> skip, force;  ///< effects left out, or simulated, regardless of the planner
  bool paired = true;               ///< graded answers: the twin also judges the camera's presentations
  bool operator==(const SimulationPlan&) const = default;
};

/// Order of presentations and rule by which the run ends.
enum class ScheduleKind {
  constant,  ///< every combination of [target] at every phase
  adaptive,  ///< chosen from earlier answers until intervals are narrow enough (tod/schedule/adaptive_schedule.h)
  ramp,      ///< the contrast falls and rises in every set-up while the plate is shifted (tod/schedule/ramp_schedule.h)
};
inline constexpr std::array all_schedule_kinds{ScheduleKind::constant, ScheduleKind::adaptive, ScheduleKind::ramp};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(ScheduleKind kind);

/// Kind of the recorded answers.
enum class AnswersChoice {
  automatic,  ///< graded if validated for the plan (chosen_answers()), otherwise binary
  binary,     ///< right or wrong
  graded,     ///< also the probability of the correct answer for the observed picture
};
inline constexpr std::array all_answers_choices{AnswersChoice::automatic, AnswersChoice::binary, AnswersChoice::graded};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(AnswersChoice choice);

/// Section [schedule], for camera and twin.
struct SchedulePlan {
  ScheduleKind kind = ScheduleKind::constant;
  double half_width_percent = 10;  ///< adaptive: target half-width of the 95 % interval of S75
  int max_presentations = 1000;    ///< adaptive: maximum over all contrasts
  /// Ramp: rate of the contrast at `from_delta_t_k`, and the contrasts at the beginning and end of the ramp. The rate
  /// decreases in proportion to the contrast.
  std::optional<double> ramp_k_per_s{}, from_delta_t_k{}, to_delta_t_k{};
  AnswersChoice answers = AnswersChoice::automatic;
  /// Successive valid frames that a graded answer averages: one number for all contrasts, or one for each of delta_t_k
  /// in its order; 0: chosen by with_frames() (bench/forecast/prediction.h).
  std::vector<int> frames_per_presentation{0};
  bool operator==(const SchedulePlan&) const = default;
};

inline constexpr std::array all_psychometric_forms{PsychometricForm::size, PsychometricForm::acuity};

/// Function that is fitted to the answers.
enum class EstimatorChoice {
  automatic,   ///< function of the twin if it applies, otherwise Weibull (chosen_estimator())
  weibull,     ///< a Weibull function
  twin_shape,  ///< function of the simulated twin
};
inline constexpr std::array all_estimator_choices{EstimatorChoice::automatic, EstimatorChoice::weibull,
                                                  EstimatorChoice::twin_shape};
/// Returns the name in plans, for example "twin-shape".
[[nodiscard]] std::string_view to_string(EstimatorChoice choice);

/// Section [fit].
struct FitPlan {
  PsychometricForm form = PsychometricForm::size;
  std::optional<double> lapse = 0.0;  ///< lapse rate; empty: fitted
  EstimatorChoice estimator = EstimatorChoice::automatic;
  bool operator==(const FitPlan&) const = default;
};

/// Row of [[limits.acuity]]: required 75 % acuity at a contrast.
struct AcuityLimit {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
  bool operator==(const AcuityLimit&) const = default;
};

/// Row of [[limits.measure]]: limits in the unit of the measure.
struct MeasureLimit {
  std::string measure = "netd";      ///< a quantity that can have a limit (quantity.h)
  std::optional<double> at_least{};  ///< temperature scale, MTF, CTF and IFOV only
  std::optional<double> at_most{};
  bool operator==(const MeasureLimit&) const = default;
};

/// Name of the zone that covers the whole frame, regardless of its stated area.
inline constexpr std::string_view whole_frame_zone = "whole";

/// Row of [[limits.zone]]: largest number of defective pixels in a part of the frame.
struct ZoneLimit {
  std::string name;
  /// Left, top, right, bottom as fractions of the frame. Default: the middle half of each side.
  std::vector<double> area{0.25, 0.25, 0.75, 0.75};
  std::optional<double> bad_pixels{}, substituted_pixels{}, clusters{}, largest_cluster{};
  bool operator==(const ZoneLimit&) const = default;
};

/// Name of the acuity in [[limits.fleet]]; other rows use the names of quantities (quantity.h).
inline constexpr std::string_view fleet_acuity = "acuity";
/// Least number of units of a fleet. The standard deviation of this number of units has a relative standard error of a
/// quarter.
inline constexpr int least_fleet_units = 10;

/// Row of [[limits.fleet]]: distribution of the true values of earlier units, as written by `todbench history prior`.
struct FleetRow {
  std::string measure{fleet_acuity};
  std::optional<double> delta_t_k{};  ///< acuity only
  double mean = 0;                    ///< mean in the unit of the measure; geometric mean for an acuity
  double sd = 0;                      ///< standard deviation of true values in that unit; of ln acuity for an acuity
  double u = 0;                       ///< standard uncertainty of one value on the scale of sd; 0: negligible
  int units = 0;
  std::string source{};
  bool operator==(const FleetRow&) const = default;
};

/// Section [limits].
struct LimitsPlan {
  std::vector<AcuityLimit> acuity;
  std::optional<double> equivalence_margin_percent;  ///< agreement with the twin; empty: not required
  std::vector<MeasureLimit> measures{};
  std::vector<ZoneLimit> zones{};
  ConformityRule rule = ConformityRule::guarded_acceptance_and_rejection;
  /// Risk of a false acceptance at the acceptance limit. The risk sets the guard band in place of the 95 % interval.
  std::optional<double> guard_band_risk{};
  std::vector<FleetRow> fleets{};
  /// Spread of true acuities over the fleet; for the risks stated by `todbench plan`.
  std::optional<double> fleet_sd_percent{};
  bool operator==(const LimitsPlan&) const = default;
};

/// Section [measurement]; see MeasurementOptions.
struct MeasurementPlan {
  int registration_frames = 32;
  int contrast_frames = 16;
  double min_reference_px = 4;
  int frames_after_change = 2;
  double max_rejected_share = 0.05;
  double max_saturated_share = 0.01;
  int frame_timeout_ms = 2000;
  double max_scale_deviation = 0.02;
  double max_rotation_deg = 10;
  double max_residual_px = 0.25;
  double max_readback_deviation_k = 0.002;  ///< set point minus read-back of the target; a larger deviation adds a note
  bool record_frames = false;               ///< write every frame to frames/, for `todbench replay`
  bool operator==(const MeasurementPlan&) const = default;
};

/// Area of the pixel check.
enum class PixelArea {
  plate,  ///< area covered by the plate
  frame,  ///< whole frame; the flat field must fill the picture
};
inline constexpr std::array all_pixel_areas{PixelArea::plate, PixelArea::frame};
/// Returns the name of the enumerator.
[[nodiscard]] constexpr std::string_view to_string(PixelArea area) {
  return area == PixelArea::frame ? "frame" : "plate";
}

/// Rule by which a pixel is bad.
enum class PixelRule {
  own,        ///< the keys pixels_response, pixels_offset and pixels_noisy
  gbt_17444,  ///< GB/T 17444-2013: response below half of the median, noise above twice the median
};
inline constexpr std::array all_pixel_rules{PixelRule::own, PixelRule::gbt_17444};
/// Returns the name in plans, "own" or "gbt-17444".
[[nodiscard]] constexpr std::string_view to_string(PixelRule rule) {
  return rule == PixelRule::gbt_17444 ? "gbt-17444" : "own";
}

/// Section [measures]: physical measures of the camera, after the trials with the same target, and of the twin.
struct MeasuresPlan {
  /// Measures temporal noise, NETD and 3-D noise from a noise cube of the first plate at contrast 0.
  bool noise = false;
  /// Frames of the noise cube.
  int noise_frames = CameraMeasuresOptions{}.noise_frames;
  /// Searches the first 256 frames of the noise cube for bad, blinking and substituted pixels.
  bool pixels = false;
  /// Area of the pixel check.
  PixelArea pixels_area = PixelArea::plate;
  /// Rule by which a pixel is bad. The thresholds below apply to PixelRule::own.
  PixelRule pixel_rule = PixelRule::own;
  /// A pixel is dead if its response to temperature deviates from the median by more than this share.
  double pixels_response = BadPixelRules{}.dead_responsivity;
  /// A pixel is dead or hot if its level deviates by more than this number times 1.4826 median deviations.
  double pixels_offset = BadPixelRules{}.offset;
  /// A pixel is noisy if its temporal noise exceeds this number times the median.
  double pixels_noisy = BadPixelRules{}.noisy;
  /// A pixel is blinking if its largest change of level, in standard uncertainties, exceeds this number times the
  /// median.
  double pixels_blinking = PixelDefectRules{}.blinking;
  /// Measures the signal transfer: observed contrast over read-back of the target.
  bool transfer = false;
  /// Contrasts of the signal transfer. The plate is located at the largest of them.
  std::vector<double> transfer_steps_k{-4, -2, -1, 1, 2, 4};
  /// Measures the growth of mean and spatial noise after a correction of the camera.
  bool drift = false;
  /// Duration of the drift measurement. The next correction ends it earlier.
  double drift_s = DriftOptions{}.drift_s;
  /// Measures the time constant of the camera from contrast steps of the first plate.
  bool response = false;
  /// Contrast of the steps: the target steps between 0 and this contrast.
  double response_delta_t_k = ResponseOptions{}.delta_t_k;
  /// Number of steps, up and down alternately. With at least 8, rise and fall are measured separately.
  int response_steps = ResponseOptions{}.steps;
  /// Frames recorded after each step.
  int response_frames = ResponseOptions{}.frames;
  /// Time in which the target completes 99.9 % of a step; empty only if the target is simulated.
  std::optional<double> response_settling_ms{};
  /// Describes the automatic gain: levels and gain at the contrasts of transfer_steps_k, and their settling after the
  /// steps of the response measurement.
  bool gain_control = false;
  /// Measures IFOV and distortion from the positions of the triangles.
  bool geometry = false;
  /// Keeps mean pictures of the smallest triangles at every contrast.
  bool triangles = false;
  /// Measures the MTF along both axes from the edges of mtf_plate.
  bool mtf = false;
  /// Plate with slanted rectangles, by name or file.
  std::string mtf_plate = "edge";
  /// Contrast of mtf_plate.
  double mtf_delta_t_k = CameraMeasuresOptions{}.mtf_delta_t_k;
  /// Frames averaged for the MTF.
  int mtf_frames = CameraMeasuresOptions{}.mtf_frames;
  /// Frequency in cycles per pixel pitch. The MTF at this frequency is reported and compared with the limit.
  double mtf_frequency_per_pitch = CameraMeasuresOptions{}.mtf_frequency_per_pitch;
  /// Measures the CTF along both axes from the bars of ctf_plate.
  bool ctf = false;
  /// Plate with bars and squares, by name or file.
  std::string ctf_plate = "bars";
  /// Contrast of ctf_plate.
  double ctf_delta_t_k = CameraMeasuresOptions{}.ctf_delta_t_k;
  /// Frames averaged for the CTF.
  int ctf_frames = CameraMeasuresOptions{}.ctf_frames;
  /// Frequency in cycles per pixel pitch. The group of bars nearest to it is reported and compared with the limit.
  double ctf_frequency_per_pitch = CameraMeasuresOptions{}.ctf_frequency_per_pitch;
  /// Measures the size-of-source effect from the apertures and opaque spots of source_size_plate.
  bool source_size = false;
  /// Plate with square apertures, by name or file.
  std::string source_size_plate = "apertures";
  /// Contrast of source_size_plate.
  double source_size_delta_t_k = CameraMeasuresOptions{}.source_delta_t_k;
  /// Frames averaged at the contrast. The same number is averaged without contrast before and after.
  int source_size_frames = CameraMeasuresOptions{}.source_frames;
  /// Side of the square source whose loss is reported and compared with the limit.
  double source_size_px = CameraMeasuresOptions{}.source_size_px;
  /// Measures accuracy, non-uniformity and repeatability over absolute temperatures of the black body.
  bool absolute = false;
  /// Plate whose cut-out is larger than the picture, by name or file.
  std::string absolute_plate = "open";
  /// Temperatures of the black body in rising order. All temperatures are shown upwards and downwards.
  std::vector<double> absolute_temperatures_k{285, 290, 295, 300, 305};
  /// Frames averaged at each temperature.
  int absolute_frames = AbsoluteOptions{}.frames;
  /// Shift of the black body on the stage. This shift separates the fixed pattern of the camera from the non-uniformity
  /// of the black body; 0: they are not separated.
  int absolute_shift_px = AbsoluteOptions{}.shift_px;
  /// Measures frame rate, jitter and gaps from the times of the frames.
  bool timing = false;
  /// Frames whose times are examined.
  int timing_frames = 500;
  /// Measures the latency from runs of the stage, in the clock of the camera.
  bool latency = false;
  /// Speed of the runs.
  double latency_mrad_s = 50;
  /// Number of runs, to the right and to the left alternately.
  int latency_runs = 8;
  /// Measures the MRTD from the bars and the MDTD from the spots of mrtd_plate, as judged by the observer.
  bool mrtd = false;
  /// Plate with groups of bars and with spots, by name or file.
  std::string mrtd_plate = "mrtd";
  /// Magnitudes of the contrasts; each is shown at both polarities.
  std::vector<double> mrtd_delta_t_k = MrtdOptions{}.contrasts_k;
  /// Frames judged at each contrast of each set-up.
  int mrtd_frames = MrtdOptions{}.frames;
  /// Number of set-ups: positions of the plate relative to the pixels.
  int mrtd_set_ups = MrtdOptions{}.set_ups;
  /// Frames of each contrast and set-up that are kept for people to judge; 0: none.
  int mrtd_kept_frames = MrtdOptions{}.kept_frames;
  /// Frequency in cycles per pixel pitch. The bars nearest to it are reported and compared with the limit.
  double mrtd_frequency_per_pitch = MrtdOptions{}.frequency_per_pitch;
  /// Side of a spot. The spot nearest to it is reported and compared with the limit.
  double mdtd_size_px = MrtdOptions{}.spot_px;
  bool operator==(const MeasuresPlan&) const = default;

  /// Returns whether any measure is on.
  [[nodiscard]] bool any() const;
};

/// Key of [measures] that requests a measure.
struct MeasureKey {
  std::string_view name;
  bool MeasuresPlan::*requested;
};
inline constexpr std::array measure_keys{MeasureKey{"noise", &MeasuresPlan::noise},
                                         MeasureKey{"pixels", &MeasuresPlan::pixels},
                                         MeasureKey{"transfer", &MeasuresPlan::transfer},
                                         MeasureKey{"drift", &MeasuresPlan::drift},
                                         MeasureKey{"response", &MeasuresPlan::response},
                                         MeasureKey{"gain_control", &MeasuresPlan::gain_control},
                                         MeasureKey{"geometry", &MeasuresPlan::geometry},
                                         MeasureKey{"triangles", &MeasuresPlan::triangles},
                                         MeasureKey{"mtf", &MeasuresPlan::mtf},
                                         MeasureKey{"ctf", &MeasuresPlan::ctf},
                                         MeasureKey{"source_size", &MeasuresPlan::source_size},
                                         MeasureKey{"absolute", &MeasuresPlan::absolute},
                                         MeasureKey{"timing", &MeasuresPlan::timing},
                                         MeasureKey{"latency", &MeasuresPlan::latency},
                                         MeasureKey{"mrtd", &MeasuresPlan::mrtd}};

/// Section [motion]: passes of a plate on a moving stage, for `todbench dynamic PLAN`.
struct MotionPlan {
  std::vector<double> speeds_mrad_s{10, 30};  ///< 0 is always included
  int passes = 8;                             ///< passes per plate, mounting, contrast and speed, alternately to the
                                              ///< right and to the left
  int frames = 8;
  int lead_frames = 5;  ///< frames of motion before the first frame that is used
  PlaceSource places = PlaceSource::triangles;
  bool operator==(const MotionPlan&) const = default;
};

/// Section [report].
struct ReportPlan {
  std::string letterhead;  ///< file (bench/plan/letterhead.h); empty: none
  bool operator==(const ReportPlan&) const = default;
};

/// Role of an instrument on the bench.
enum class InstrumentRole {
  by_name,     ///< not stated; determined by "black body" or "plate stage" in the name of the row, otherwise `other`
  black_body,  ///< the calibration of the instrument enters the uncertainty budget
  plate_stage,
  other,  ///< the report lists it
};
inline constexpr std::array all_instrument_roles{InstrumentRole::by_name, InstrumentRole::black_body,
                                                 InstrumentRole::plate_stage, InstrumentRole::other};
/// Returns the role in words.
[[nodiscard]] constexpr std::string_view to_string(InstrumentRole role) {
  switch (role) {
    case InstrumentRole::by_name:
      return "by name";
    case InstrumentRole::black_body:
      return "black body";
    case InstrumentRole::plate_stage:
      return "plate stage";
    case InstrumentRole::other:
      break;
  }
  return "other";
}

/// Row of [[instrument]]: instrument on whose calibration the result depends. Printed in the report; an expired due
/// date prevents the measurement.
struct InstrumentPlan {
  std::string name, serial, certificate;
  std::string calibration_due;  ///< "YYYY-MM-DD", the last valid day; empty: no due date
  /// File of the digital calibration certificate. Empty in a plan that was read, because the plan then contains its
  /// values.
  std::string dcc{};
  std::string dcc_quantity{};  ///< quantity of the certificate that is the calibration; empty: all temperatures
  InstrumentRole role = InstrumentRole::by_name;
  bool operator==(const InstrumentPlan&) const = default;
};

/// Returns the role of an instrument: the stated role, or the role that its name implies; never `by_name`.
[[nodiscard]] InstrumentRole role_of(const InstrumentPlan& instrument);

/// Complete plan with all defaults filled in.
struct Plan {
  std::string name = "unnamed", description;
  std::string operator_name;  ///< key `operator`
  std::string place;
  std::string unit;  ///< unit under test, free text
  std::string notes;
  std::uint64_t seed = 1;  ///< below 2^63
  CameraPlan camera;
  TargetPlan target;
  std::string observer = "hvs-1";  ///< name or file; key `name` of [observer]
  /// Section [display]: the display of the operator, for an observer with an eye. All defaults: not stated.
  ViewedDisplay display;
  /// Reports the thresholds of hvs-2 at the display in addition to the observer's thresholds; key `as_operator` of
  /// [display].
  bool display_as_operator = false;
  SimulationPlan simulation;
  SchedulePlan schedule;
  FitPlan fit;
  LimitsPlan limits;
  MeasurementPlan measurement;
  MeasuresPlan measures;
  MotionPlan motion;
  ReportPlan report;
  UncertaintyPlan uncertainty;
  std::vector<InstrumentPlan> instruments;
  OrderPlan order{};  ///< all defaults: not stated
  /// Rows of [[module]]. Modules of place picture run in this order after the camera and its twin. At most one has
  /// place observer.
  std::vector<ModulePlan> modules{};
  bool operator==(const Plan&) const = default;
};

/// Returns whether the plan states an entry of [order].
[[nodiscard]] inline bool has_order(const Plan& plan) {
  return plan.order != OrderPlan{};
}
/// Returns whether the plan has a section [display].
[[nodiscard]] inline bool has_display(const Plan& plan) {
  return plan.display != ViewedDisplay{};
}

/// Reads a plan by name ("demo") or file. The keys are the rows of bench/plan/..._keys.cpp; docs/reference/plan-keys.md
/// lists them. Relative file names in the plan are relative to its folder; the result has absolute names. Errors:
/// `invalid_input` with file and line (key or value unknown, missing, of the wrong type, out of range, contradictory,
/// or a file not found).
[[nodiscard]] Result<Plan> load_plan(std::string_view reference);
/// Parses text already read; relative file names are relative to `folder`.
[[nodiscard]] Result<Plan> parse_plan(const Resource& resource, const std::filesystem::path& folder);
/// Returns the complete plan as TOML. parse_plan() of this text returns an equal plan.
[[nodiscard]] std::string to_toml(const Plan& plan);

/// Checks a plan that was not read from a file for the mistakes that parse_plan() rejects: values out of range,
/// contradictions. Errors: `invalid_input` about the key. Named descriptions are not looked up; LoadedPlan::load() does
/// that (bench/plan/loaded_plan.h).
[[nodiscard]] Result<void> validate(const Plan& plan);

/// Returns the relative standard uncertainty of the camera's temperature scale from the contrast rows of the budget,
/// without the camera-scale row. Rows in kelvin are divided by the largest step of the signal transfer. The value is
/// the standard deviation of a normal distribution with the same 95 % interval (factor 1.96), as in the two functions
/// below.
[[nodiscard]] double relative_u_of_scale(const Plan& plan);
/// Returns the relative standard uncertainty of a temperature difference on the camera's scale, from the camera-scale
/// row.
[[nodiscard]] double relative_u_of_camera_scale(const Plan& plan);
/// Returns the relative standard uncertainty of an angle per pixel, from the rows of distance and entrance pupil.
[[nodiscard]] double relative_u_of_distance(const Plan& plan);
/// Returns the standard uncertainty of ln acuity from the rows whose sensitivity is known before the measurement,
/// without the rows shared with `common`.
[[nodiscard]] double known_u_of_acuity(const Plan& plan, BudgetCommon common);

/// Fails if the due date of an instrument is before `today`. Error: code `calibration`, one sentence that names all
/// these instruments.
[[nodiscard]] Result<void> check_calibration(const Plan& plan, std::chrono::year_month_day today);

}  // namespace todbench
