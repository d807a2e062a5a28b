// SPDX-License-Identifier: GPL-3.0-or-later
// Provenance of a session: program, host, camera, instruments and events of the run.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "bench/plan/plan_options.h"
#include "bench/session/display_record.h"
#include "bench/session/json_output.h"
#include "bench/session/selftest_record.h"
#include "tod/measurement/measurement.h"

namespace todbench {

/// State of a session.
enum class SessionState {
  running,  ///< in progress, or ended by a crash
  complete,
  interrupted,  ///< stopped on request or by an error; earlier trials are valid
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(SessionState state);

/// Camera properties as read back.
struct CameraRecord {
  std::string id, vendor, model, serial, firmware, transport, pixel_format;
  int width = 0, height = 0, significant_bits = 0;
  double frame_rate_hz = 0;                     ///< 0: unknown
  std::string calibration;                      ///< conversion of counts to kelvin, in words
  std::map<std::string, std::string> settings;  ///< feature -> value
  std::vector<std::string> warnings;
  bool operator==(const CameraRecord&) const = default;
};
/// Returns the properties that the camera reported.
[[nodiscard]] CameraRecord camera_record(const SourceInfo& info);

/// Result of a run except its trials.
struct RunRecord {
  double wall_s = 0;
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;
  std::uint64_t frames_lost = 0;
  double temporal_noise_k = 0;  ///< 0: not measured
  std::vector<SetUpRecord> set_ups;
  std::vector<std::string> notes;
  std::vector<Interruption> interruptions;  ///< camera losses that the run survived
  std::string ended_by;                     ///< reason for an early end; empty: complete
  double measures_s = 0;                    ///< part of wall_s: physical measures with their changes of the target
};
/// Returns the record of a measurement.
[[nodiscard]] RunRecord run_record(const MeasurementResult& result, double wall_s);
/// Returns the figures of a run.
[[nodiscard]] RunFigures figures_of(const RunRecord& run);

/// Optics and noise of the camera as estimated from its own frames (bench/twin/camera_surrogate.h).
struct CameraOpticsRecord {
  double aberration_sigma_pitch = 0, aberration_se_pitch = 0;
  double f_number_ratio = 1, f_number_ratio_se = 0;  ///< f-number relative to the sensor file, and standard error
  int samples_per_pitch = 1;
  double chi2 = 0, chi2_limit = 0, degrees_of_freedom = 0;
  double netd_k = 0, row_noise_k = 0, column_noise_k = 0, fixed_pattern_k = 0, noise_correlation = 0;
  std::optional<double> halo_share{}, halo_share_se{}, halo_sigma_px{};  ///< halo in excess of the twin's: share,
                                                                         ///< standard error, sigma
  bool refused = false;                                                  ///< chi2 exceeds its limit
  bool surrogate_taken = false;  ///< the camera's fit uses the function of the surrogate
  /// Response of the contrast estimator by plate. Contrasts were divided by this response.
  std::map<std::string, double> contrast_response{};
  bool operator==(const CameraOpticsRecord&) const = default;
};

/// Observer that judged the frames of a session, and the enhancement package applied to the frames before the
/// judgement.
struct JudgedBy {
  std::string observer;         ///< name
  std::string observer_sha256;  ///< SHA-256 of the description of the observer
  std::string package;          ///< name; empty: none
  std::string package_sha256;   ///< SHA-256 of the file of the package
  bool operator==(const JudgedBy&) const = default;
};

/// Origin of a session that judged recorded frames again.
struct OriginRecord {
  std::string session;          ///< folder of the recorded session
  std::string manifest_sha256;  ///< digest of the manifest of that session; empty: no manifest
  std::string signed_by;        ///< SHA-256 of the key of the valid signature of that session; empty: not signed
  JudgedBy then, now;
  /// True if the session contains the recorded frames up to the interruption, followed by new frames of the camera.
  bool resumed = false;
  bool operator==(const OriginRecord&) const = default;
};

/// Bench times that were forecast from the plan before the run.
struct TimeForecast {
  double total_s = 0;                     ///< total without computing
  std::map<std::string, double> parts_s;  ///< by part of the bill (bench/report/accuracy_bill.h)
  bool operator==(const TimeForecast&) const = default;
};

struct Provenance {
  std::string program_version, git_commit, compiler;
  std::string host;
  std::string started_utc;  ///< ISO 8601 with Z
  std::string ended_utc;    ///< start plus time by the monotonic clock; empty: still running
  double clock_jump_s = 0;  ///< forward jump of the host's clock during the run
  SessionState state = SessionState::running;
  Side side = Side::measured;  ///< side of the comparison whose answers trials.csv contains
  std::map<std::string, std::uint64_t> seeds;
  std::optional<CameraRecord> camera;  ///< empty for a simulated curve
  std::string target;                  ///< instruments in words, with serial numbers
  std::vector<InstrumentPlan> instruments;
  std::vector<ModuleRecord> modules{};  ///< modules after the camera or its twin; the observer last
  SensorPlan effects;                   ///< effects of the simulated curve
  std::optional<RunRecord> run;         ///< run that wrote trials.csv
  /// Forecast to compare with the times of `run`. Empty: not measured, a simulated scene, recorded frames, or an early
  /// end.
  std::optional<TimeForecast> forecast{};
  std::optional<RunRecord> twin_run;  ///< run that wrote trials_simulated.csv
  std::optional<CameraOpticsRecord> camera_optics{};
  /// The last self-test of this program on this computer; empty: none.
  std::optional<SelftestRecord> selftest{};
  /// Origin of the frames; present if the frames come from an earlier session.
  std::optional<OriginRecord> origin{};
  /// Limits of the acuity, and thresholds of an operator at the display; empty: no observer with an eye.
  std::optional<DisplayRecord> at_display{};
};

/// Returns the number of parts between camera losses; 1: the camera was never lost.
[[nodiscard]] std::size_t segments(const Provenance& provenance);
/// Returns whether the run was not continuous: it ended early, or the camera was lost and came back. `state` shows
/// whether the run made all trials.
[[nodiscard]] bool was_interrupted(const Provenance& provenance);

/// Returns the provenance with program, host, start time, seed and instruments of the plan; state running.
[[nodiscard]] Provenance begin_provenance(const Plan& plan, Side side);
/// Returns the name of this computer; "unknown" without one.
[[nodiscard]] std::string host_name();
/// Returns the current time as "2026-01-31T12:34:56Z".
[[nodiscard]] std::string utc_now();

/// Returns the content of provenance.json. Errors: those of json_of().
[[nodiscard]] Result<Json> provenance_json(const Provenance& provenance);
/// Parses a record. Errors: those of from_json().
[[nodiscard]] Result<Provenance> provenance_from(const Json& json);

}  // namespace todbench
