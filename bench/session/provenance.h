// Where a session comes from: program, host, camera, instruments, what happened on the way.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "bench/plan/plan_options.h"
#include "bench/session/json_output.h"
#include "tod/measurement/measurement.h"

namespace todbench {

enum class SessionState {
  running,  ///< still being written, or cut off by a crash
  complete,
  interrupted,  ///< stopped on request or by an error; the trials so far are valid
};
[[nodiscard]] std::string_view to_string(SessionState state);

/// The camera as it was read back.
struct CameraRecord {
  std::string id, vendor, model, serial, firmware, transport, pixel_format;
  int width = 0, height = 0, significant_bits = 0;
  double frame_rate_hz = 0;                     ///< 0: unknown
  std::string calibration;                      ///< of counts to kelvin, in words
  std::map<std::string, std::string> settings;  ///< feature -> value
  std::vector<std::string> warnings;
  bool operator==(const CameraRecord&) const = default;
};
[[nodiscard]] CameraRecord camera_record(const SourceInfo& info);

/// What one run left behind besides its trials.
struct RunRecord {
  double wall_s = 0;
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;
  std::uint64_t frames_lost = 0;
  double temporal_noise_k = 0;  ///< 0: not measured
  std::vector<SetUpRecord> set_ups;
  std::vector<std::string> notes;
  std::vector<Interruption> interruptions;  ///< losses of the camera that the run survived
  std::string ended_by;                     ///< why it stopped early; empty: it did not
};
[[nodiscard]] RunRecord run_record(const MeasurementResult& result, double wall_s);
[[nodiscard]] RunFigures figures_of(const RunRecord& run);

struct Provenance {
  std::string program_version, git_commit, compiler;
  std::string host;
  std::string started_utc;  ///< ISO 8601 with Z
  std::string ended_utc;    ///< the start, and what passed by a clock that is never set; empty: not yet
  double clock_jump_s = 0;  ///< by how much the clock of the host was set ahead meanwhile
  SessionState state = SessionState::running;
  Side side = Side::measured;  ///< what trials.csv holds
  std::map<std::string, std::uint64_t> seeds;
  std::optional<CameraRecord> camera;  ///< nothing for a simulated curve
  std::string target;                  ///< instruments in words, with serial numbers
  std::vector<InstrumentPlan> instruments;
  std::vector<ModuleRecord> modules{};  ///< behind camera or twin, the observer last
  SensorPlan effects;                   ///< of the simulated curve
  std::optional<RunRecord> run;         ///< of trials.csv
  std::optional<RunRecord> twin_run;    ///< of trials_simulated.csv
};

/// The parts between losses of the camera; 1: it was never lost.
[[nodiscard]] std::size_t segments(const Provenance& provenance);
/// Ended early, or the camera was lost on the way and came back: nobody may take it for a run in one piece. `state`
/// says whether it has all its trials.
[[nodiscard]] bool was_interrupted(const Provenance& provenance);

/// Program, host, start and the seed and instruments of the plan filled in; state running.
[[nodiscard]] Provenance begin_provenance(const Plan& plan, Side side);
/// Now, as "2026-01-31T12:34:56Z".
[[nodiscard]] std::string utc_now();

[[nodiscard]] Json provenance_json(const Provenance& provenance);
/// `invalid_input` naming the key.
[[nodiscard]] Result<Provenance> provenance_from(const Json& json);

}  // namespace todbench
