// The plan of a measurement: what is measured with what, how long, and what is demanded. A value; the file is TOML.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "acquisition/core/result.h"
#include "bench/plan/budget_row.h"
#include "bench/plan/conformity_rule.h"
#include "bench/plan/resources.h"
#include "sim_devices/module/module_plan.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/measurement/measurement.h"
#include "tod/measurement/place_source.h"
#include "tod/plate/target_plate.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/schedule/schedule.h"

namespace todbench {

/// [camera]: the real or emulated camera. Without an id the plan can only be simulated.
struct CameraPlan {
  std::string id;                                ///< as `todbench devices` lists it, e.g. "gige:FLIR-48000123"
  double ifov_mrad = 0;                          ///< of one pixel; required with an id
  double nuc_interval_s = 0;                     ///< correct the non-uniformity this often; 0: never commanded
  double nuc_wait_s = 1;                         ///< frames within this time after a correction are not measured
  std::map<std::string, std::string> settings;   ///< feature -> value, set before the run and read back
  double reconnect_s = 60;                       ///< how long a lost camera is waited for; 0: not at all
  ContrastUnit contrast = ContrastUnit::kelvin;  ///< of the camera alone; the twin is measured in kelvin
  bool operator==(const CameraPlan&) const = default;
};

enum class TargetKind {
  scpi,    ///< black body and plate stage on the network
  prompt,  ///< the operator changes the target when asked
  scene,   ///< the simulated scene of a simulated or emulated camera
  display  ///< a monitor that the bench draws on
};
inline constexpr std::array all_target_kinds{TargetKind::scpi, TargetKind::prompt, TargetKind::scene,
                                             TargetKind::display};
[[nodiscard]] std::string_view to_string(TargetKind kind);

/// [target]: what is shown, in every combination.
struct TargetPlan {
  TargetKind kind = TargetKind::scene;
  std::string black_body;                            ///< address of the instrument; required for kind scpi
  std::string stage;                                 ///< the same for the stage that moves the plate
  std::string black_body_table = "scpi-black-body";  ///< its words, by name or file
  std::string stage_table = "scpi-stage";
  /// Of kind display: the program that shows pictures, the screen, and the contrast of black beside white.
  std::string display = "todbench-gui --pictures";
  int display_width_px = 1920, display_height_px = 1080;
  double display_pixel_mm = 0, display_span_k = 0, display_gamma = 1, display_settle_s = 0.2;
  std::vector<double> display_luminance{0, 1};          ///< of equally spaced levels from black to white
  double distance_m = 2;                                ///< entrance pupil to plate; required in a file
  std::vector<std::string> plates{"tcat-a", "tcat-b"};  ///< names or files
  std::vector<Mounting> mountings{all_mountings.begin(), all_mountings.end()};
  std::vector<double> delta_t_k{16.9, 1.93, 0.23};  ///< set-points, never 0; the sign is the polarity
  int phases = 16;                                  ///< sub-pixel shifts per plate, mounting and contrast
  /// Of the air between plate and camera; 0 % humidity: not stated, and nothing is corrected.
  double air_temperature_c = 20, air_humidity_percent = 0;
  double settle_timeout_s = 600;
  double plate_change_s = 60, mounting_change_s = 30, contrast_change_s = 20, shift_change_s = 0.1;
  bool operator==(const TargetPlan&) const = default;
};

/// [simulation]: the twin.
struct SimulationPlan {
  std::string sensor = "sc2000";    ///< name or file
  std::string accuracy = "normal";  ///< draft, normal, reference, or auto: from tolerance_percent alone
  double tolerance_percent = 1;     ///< of the 75 % acuity
  int microscan = 1;                ///< in place of the sensor's own, which a file need not repeat
  int phases = 16;       ///< sub-pixel shifts per plate, mounting and contrast, in place of those of [target]
  SceneMotion motion{};  ///< of the target; matters where the sensor has a time constant
  std::vector<Effect> skip, force;
  bool paired = true;  ///< graded answers: the twin is shown the camera's own presentations, too
  bool operator==(const SimulationPlan&) const = default;
};

enum class ScheduleKind {
  constant,  ///< every combination of [target], in every phase
  adaptive,  ///< what the answers so far leave open, until intervals are narrow enough
             ///< (tod/schedule/adaptive_schedule.h)
};
inline constexpr std::array all_schedule_kinds{ScheduleKind::constant, ScheduleKind::adaptive};
[[nodiscard]] std::string_view to_string(ScheduleKind kind);

/// What answers are to be taken.
enum class AnswersChoice {
  automatic,  ///< graded where that is proven (chosen_answers()), else right and wrong
  binary,     ///< right or wrong
  graded,     ///< the probability of the right answer given what was seen, too
};
inline constexpr std::array all_answers_choices{AnswersChoice::automatic, AnswersChoice::binary, AnswersChoice::graded};
[[nodiscard]] std::string_view to_string(AnswersChoice choice);

/// [schedule]: of camera and twin.
struct SchedulePlan {
  ScheduleKind kind = ScheduleKind::constant;
  double half_width_percent = 10;  ///< adaptive: wanted half-width of the 95 % interval of S75
  int max_presentations = 1000;    ///< adaptive: hard cap over all contrasts
  AnswersChoice answers = AnswersChoice::automatic;
  /// Successive good ones, over which graded answers are averaged: of every contrast, or one number for each of
  /// delta_t_k in its order; 0: chosen by with_frames() (bench/run/prediction.h).
  std::vector<int> frames_per_presentation{0};
  bool operator==(const SchedulePlan&) const = default;
};

inline constexpr std::array all_psychometric_forms{PsychometricForm::size, PsychometricForm::acuity};

/// With what function answers are to be fitted.
enum class EstimatorChoice {
  automatic,   ///< that of the simulated twin where there is one, else a Weibull function (chosen_estimator())
  weibull,     ///< a Weibull function
  twin_shape,  ///< the function of the simulated twin
};
inline constexpr std::array all_estimator_choices{EstimatorChoice::automatic, EstimatorChoice::weibull,
                                                  EstimatorChoice::twin_shape};
[[nodiscard]] std::string_view to_string(EstimatorChoice choice);

/// [fit]
struct FitPlan {
  PsychometricForm form = PsychometricForm::size;
  std::optional<double> lapse = 0.0;  ///< nothing: free
  EstimatorChoice estimator = EstimatorChoice::automatic;
  bool operator==(const FitPlan&) const = default;
};

/// What can be demanded of a unit. bench/judgement/demand_kinds.cpp has a row for each: its name, how it is judged, how
/// it is shown.
enum class DemandKind {
  acuity,       ///< the 75 % acuity at a contrast, [[limits.acuity]]
  identified,   ///< a threshold with both sides of its interval, at every contrast without a limit on acuity
  equivalence,  ///< agreement with the simulated twin, [limits] equivalence_margin_percent
  // Physical measures, [[limits.measure]].
  netd,
  temporal_noise,
  noise_t,
  noise_v,
  noise_h,
  noise_tv,
  noise_th,
  noise_vh,
  noise_tvh,
  temperature_scale_at_least,  ///< contrast seen over contrast shown
  temperature_scale_at_most,
  mtf_x,
  mtf_y,
  ctf_x,
  ctf_y,
  ifov_x_at_least,
  ifov_x_at_most,
  ifov_y_at_least,
  ifov_y_at_most,
  distortion,
  drift_rate,
  drift_pattern_rate,
  response_time,
  scene_dependence,  ///< of the response on a hot bar in the field, `todbench scene-dependence`
  // Pixels of a zone, [[limits.zone]].
  zone_bad_pixels,
  zone_substituted_pixels,
  zone_clusters,
  zone_largest_cluster,
};

/// [[limits.acuity]]: the 75 % acuity demanded at a contrast.
struct AcuityLimit {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
  bool operator==(const AcuityLimit&) const = default;
};

/// Physical measures that can be limited, by their names in measures.json.
enum class LimitedMeasure {
  netd,
  temporal_noise,
  noise_t,
  noise_v,
  noise_h,
  noise_tv,
  noise_th,
  noise_vh,
  noise_tvh,
  transfer_slope,  ///< the temperature scale
  mtf_x,           ///< at the frequency of [measures]
  mtf_y,
  ctf_x,  ///< best phase, of the group nearest to the frequency of [measures]
  ctf_y,
  ifov_x,
  ifov_y,
  distortion,          ///< at the corner, of either sign
  drift_rate,          ///< of the mean, of either sign
  drift_pattern_rate,  ///< of the spatial noise
  response_time,
};
inline constexpr std::array limited_measures{LimitedMeasure::netd,
                                             LimitedMeasure::temporal_noise,
                                             LimitedMeasure::noise_t,
                                             LimitedMeasure::noise_v,
                                             LimitedMeasure::noise_h,
                                             LimitedMeasure::noise_tv,
                                             LimitedMeasure::noise_th,
                                             LimitedMeasure::noise_vh,
                                             LimitedMeasure::noise_tvh,
                                             LimitedMeasure::transfer_slope,
                                             LimitedMeasure::mtf_x,
                                             LimitedMeasure::mtf_y,
                                             LimitedMeasure::ctf_x,
                                             LimitedMeasure::ctf_y,
                                             LimitedMeasure::ifov_x,
                                             LimitedMeasure::ifov_y,
                                             LimitedMeasure::distortion,
                                             LimitedMeasure::drift_rate,
                                             LimitedMeasure::drift_pattern_rate,
                                             LimitedMeasure::response_time};
[[nodiscard]] std::string_view to_string(LimitedMeasure measure);
/// An MTF or a CTF.
[[nodiscard]] bool is_modulation(LimitedMeasure measure);
/// An angle per pixel.
[[nodiscard]] bool is_ifov(LimitedMeasure measure);
/// Which limits a measure can have.
[[nodiscard]] bool takes_at_least(LimitedMeasure measure);
[[nodiscard]] bool takes_at_most(LimitedMeasure measure);

/// [[limits.measure]]: limits on a physical measure, in its unit.
struct MeasureLimit {
  LimitedMeasure measure = LimitedMeasure::netd;
  std::optional<double> at_least{};  ///< of the temperature scale, an MTF, a CTF and an IFOV
  std::optional<double> at_most{};
  bool operator==(const MeasureLimit&) const = default;
};

/// Where a zone named so begins and ends, in place of its own.
inline constexpr std::string_view whole_frame_zone = "whole";

/// [[limits.zone]]: most pixels of a kind in a part of the frame.
struct ZoneLimit {
  std::string name;
  /// Left, top, right, bottom in fractions of the frame. Default: the middle half of each side.
  std::vector<double> area{0.25, 0.25, 0.75, 0.75};
  std::optional<double> bad_pixels{}, substituted_pixels{}, clusters{}, largest_cluster{};
  bool operator==(const ZoneLimit&) const = default;
};

/// Name of the acuity in [[limits.fleet]]; the others are those of LimitedMeasure.
inline constexpr std::string_view fleet_acuity = "acuity";
/// Units that say something of a spread: its standard deviation is known to a quarter.
inline constexpr int least_fleet_units = 10;

/// [[limits.fleet]]: true values of earlier units of this kind, as `todbench history prior` states them.
struct FleetRow {
  std::string measure{fleet_acuity};
  std::optional<double> delta_t_k{};  ///< of an acuity
  double mean = 0;                    ///< in the unit of the measure; of an acuity the geometric one
  double sd = 0;                      ///< of true values, in that unit; of an acuity in ln acuity
  double u = 0;                       ///< of the values that say so, on the scale of sd; 0: as good as nothing
  int units = 0;
  std::string source{};
  bool operator==(const FleetRow&) const = default;
};

/// [limits]
struct LimitsPlan {
  std::vector<AcuityLimit> acuity;
  std::optional<double> equivalence_margin_percent;  ///< demanded agreement with the twin; nothing: not demanded
  std::vector<MeasureLimit> measures{};
  std::vector<ZoneLimit> zones{};
  ConformityRule rule = ConformityRule::guarded_acceptance_and_rejection;
  /// Of a wrong acceptance at the acceptance limit, in place of the 95 % interval as guard band.
  std::optional<double> guard_band_risk{};
  std::vector<FleetRow> fleets{};
  std::optional<double> fleet_sd_percent{};  ///< of true acuities over the fleet; for what `plan` says beforehand
  bool operator==(const LimitsPlan&) const = default;
};

/// [measurement]: see MeasurementOptions.
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
  double max_readback_deviation_k = 0.002;  ///< of what the target says it shows from what it was told; beyond: a note
  bool record_frames = false;               ///< every frame of the camera into frames/, for `todbench replay`
  bool operator==(const MeasurementPlan&) const = default;
};

/// Where pixels are looked at.
enum class PixelArea {
  plate,  ///< what the plate covers
  frame,  ///< everything: the flat field fills the picture
};
inline constexpr std::array all_pixel_areas{PixelArea::plate, PixelArea::frame};
[[nodiscard]] constexpr std::string_view to_string(PixelArea area) {
  return area == PixelArea::frame ? "frame" : "plate";
}

/// [measures]: physical measures after the trials, with the same camera and target, and of the twin.
struct MeasuresPlan {
  bool noise = false;     ///< temporal noise, NETD and 3-D noise, of the first plate at a contrast of 0
  int noise_frames = 64;  ///< of the cube
  bool pixels = false;    ///< bad and substituted ones, from the cube of the noise
  PixelArea pixels_area = PixelArea::plate;
  double pixels_response = 0.25;  ///< dead: response off the median's by more than this part of it
  double pixels_offset = 5;       ///< dead or hot: level off by so many 1.4826 median deviations
  double pixels_noisy = 3;        ///< temporal noise above so many medians
  double pixels_blinking = 3;     ///< change of level above so many medians of it
  bool transfer = false;          ///< contrast seen over contrast shown
  std::vector<double> transfer_steps_k{-4, -2, -1, 1, 2, 4};
  bool drift = false;                            ///< growth of mean and spatial noise after a correction
  double drift_s = 20;                           ///< watched
  bool response = false;                         ///< time constant, from steps of the first plate's contrast
  double response_delta_t_k = 10;                ///< between which and 0 it steps
  int response_steps = 16;                       ///< to and fro in turn
  int response_frames = 24;                      ///< behind each
  std::optional<double> response_settling_ms{};  ///< of the target's step; nothing: a simulated one steps at once
  bool geometry = false;                         ///< IFOV and distortion, from the places of the triangles
  bool triangles = false;                        ///< pictures of the smallest ones at every contrast
  bool mtf = false;                              ///< along both axes, from the edges of a plate of its own
  std::string mtf_plate = "edge";                ///< name or file
  double mtf_delta_t_k = 10;                     ///< at which it is shown
  int mtf_frames = 64;                           ///< averaged
  double mtf_frequency_per_pitch = 0.25;         ///< at which the MTF is stated and limited
  bool ctf = false;                              ///< along both axes, from the bars of a plate of its own
  std::string ctf_plate = "bars";                ///< name or file
  double ctf_delta_t_k = 10;                     ///< at which it is shown
  int ctf_frames = 64;                           ///< averaged
  double ctf_frequency_per_pitch = 0.4;          ///< the group nearest to it is stated and limited
  bool operator==(const MeasuresPlan&) const = default;

  /// Whether any is on.
  [[nodiscard]] bool any() const {
    return noise || transfer || drift || response || geometry || triangles || mtf || ctf;
  }
};

/// [motion]: passes of a plate that a stage moves, for `todbench dynamic PLAN`.
struct MotionPlan {
  std::vector<double> speeds_mrad_s{10, 30};  ///< 0 is added
  int passes = 8;  ///< of every plate, mounting, contrast and speed, to the right and to the left in turn
  int frames = 8;
  int lead_frames = 5;  ///< of motion before the first
  PlaceSource places = PlaceSource::triangles;
  bool operator==(const MotionPlan&) const = default;
};

/// [report]
struct ReportPlan {
  std::string letterhead;  ///< file (bench/plan/letterhead.h); empty: none
  bool operator==(const ReportPlan&) const = default;
};

/// [[instrument]]: what the calibration of the result hangs on. For the report; a date that has passed refuses the
/// measurement.
struct InstrumentPlan {
  std::string name, serial, certificate;
  std::string calibration_due;  ///< "YYYY-MM-DD", the last valid day; empty: no due date
  bool operator==(const InstrumentPlan&) const = default;
};

/// Everything with its default filled in.
struct Plan {
  std::string name = "unnamed", description;
  std::string operator_name;  ///< key `operator`
  std::string place;
  std::string unit;  ///< unit under test, in the words of who tests it
  std::string notes;
  std::uint64_t seed = 1;  ///< below 2^63
  CameraPlan camera;
  TargetPlan target;
  std::string observer = "hvs-1";  ///< name or file; key `name` of [observer]
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
  /// [[module]]: those of place picture in the order of their rows behind camera and twin; at most one of place
  /// observer.
  std::vector<ModulePlan> modules{};
  bool operator==(const Plan&) const = default;
};

/// A plan's keys are the rows of bench/plan/..._keys.cpp; docs/plan-keys.md lists them.
///
/// Reads a plan by name ("demo") or file. Relative files named in it are relative to its folder and absolute in the
/// result. `invalid_input` with file and line for anything unknown, missing, of the wrong type, out of range,
/// contradictory or not found.
[[nodiscard]] Result<Plan> load_plan(std::string_view reference);
/// The same from text already read; `folder` is where relative files are looked for.
[[nodiscard]] Result<Plan> parse_plan(const Resource& resource, const std::filesystem::path& folder);
/// The plan as TOML with nothing left out: parse_plan() of it is equal.
[[nodiscard]] std::string to_toml(const Plan& plan);

/// What parse_plan() refuses in a file, of a plan that was made in any other way: values out of range and what
/// contradicts each other. `invalid_input` about the key. What the plan names is not looked for: that is
/// LoadedPlan::load() (bench/plan/loaded_plan.h).
[[nodiscard]] Result<void> validate(const Plan& plan);

/// Relative standard uncertainty that the stated rows give the temperature scale of a camera: those of the contrast,
/// without the camera's own; kelvin count by the largest step of the signal transfer. 1.96 of it hold 95 %.
[[nodiscard]] double relative_u_of_scale(const Plan& plan);
/// The same for a temperature difference in the camera's scale: its camera-scale row.
[[nodiscard]] double relative_u_of_camera_scale(const Plan& plan);
/// The same for an angle per pixel: the rows of the distance and of the entrance pupil.
[[nodiscard]] double relative_u_of_distance(const Plan& plan);
/// Standard uncertainty of ln acuity from the stated rows whose sensitivity is known before the measurement, without
/// those that are shared with `common`.
[[nodiscard]] double known_u_of_acuity(const Plan& plan, BudgetCommon common);

/// The instruments whose due date is before `today`, as one sentence with code `calibration`; success when there is
/// none.
[[nodiscard]] Result<void> check_calibration(const Plan& plan, std::chrono::year_month_day today);

}  // namespace todbench
