// SPDX-License-Identifier: GPL-3.0-or-later
// Session folder of a run: a writer that keeps the folder valid at every moment, and a reader of its content.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/judgement/acuity_uncertainty.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/loaded_plan.h"
#include "bench/session/manifest.h"
#include "bench/session/measures_record.h"
#include "bench/session/provenance.h"
#include "bench/session/session_clock.h"
#include "bench/session/targets_csv.h"
#include "bench/session/trials_csv.h"
#include "bench/text/folders.h"
#include "sim_devices/prediction/cost_frontier.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Treatment of a folder that is not empty.
enum class ExistingFolder {
  refuse,
  overwrite,  ///< removes the files of an earlier session, never other files
  number,     ///< creates a sibling folder with suffix -2, -3 ...
};

/// Returns "session-20260131T123456Z-NAME" with the current time. A second session within the same second needs
/// ExistingFolder::number.
[[nodiscard]] std::string session_folder_name(const std::string& plan_name);

/// Curve of a session: main curve or simulated twin.
enum class SessionCurve { main, twin };

/// Writer of a session. All files except trials, targets and log are written atomically. One thread at a time. Other
/// programs cannot start a session in the folder until the last copy of this object is destroyed. Errors of every
/// function: `io` with the path.
class SessionFolder {
 public:
  /// Creates the folder with its parents; the session starts now. Errors: `invalid_input` (folder not empty and not to
  /// be overwritten, another session is being written to it, the path or a parent is a file), `io` (cannot be created
  /// or written).
  [[nodiscard]] static Result<SessionFolder> create(const std::filesystem::path& folder, ExistingFolder existing,
                                                    const HostClocks& clocks = host_clocks());

  /// Returns the path of the folder.
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  /// Returns the clock of the session.
  [[nodiscard]] const SessionClock& clock() const { return clock_; }
  /// Writes session.toml. Copies the plates, sensor, observer and letterhead to inputs/ and redirects file references
  /// to the copies. References to built-in descriptions remain names.
  [[nodiscard]] Result<void> write_plan(const LoadedPlan& loaded);
  /// Writes provenance.json: at the start with state `running`, and again when more facts are known.
  [[nodiscard]] Result<void> write_provenance(const Provenance& provenance);
  /// Opens trials.csv or trials_simulated.csv.
  [[nodiscard]] Result<TrialsWriter> open_trials(SessionCurve which);
  /// Opens targets.csv or targets_simulated.csv.
  [[nodiscard]] Result<TargetsWriter> open_targets(SessionCurve which);
  /// Writes fits.json, curve.csv and, if the main curve has a budget, uncertainty.json.
  [[nodiscard]] Result<void> write_curves(const TodCurve& main, const std::optional<TodCurve>& twin, Side side,
                                          const std::optional<CurveUncertainty>& uncertainty = {});
  /// Writes comparison.json.
  [[nodiscard]] Result<void> write_comparison(const Comparison& comparison);
  /// Writes grey-levels.csv: contrast and signal transfer of every judged frame.
  [[nodiscard]] Result<void> write_grey_levels(const std::vector<GreyFrame>& frames);
  /// Writes measures.json and its pictures in pictures/.
  [[nodiscard]] Result<void> write_measures(const std::optional<CameraMeasures>& main,
                                            const std::optional<CameraMeasures>& twin);
  /// Writes a record of measures_record() as the overload above. Errors: also the error of the record.
  [[nodiscard]] Result<void> write_measures(Result<Json> record);
  /// Writes verdict.json.
  [[nodiscard]] Result<void> write_verdict(const Verdict& verdict);
  /// Writes report.html.
  [[nodiscard]] Result<void> write_report(std::string_view html);
  /// Appends a line to log.txt with the time of the session clock.
  [[nodiscard]] Result<void> log(std::string_view sentence);
  /// Writes the provenance with `state` and, if absent, the end time, then the manifest. Call it last, also after an
  /// interruption.
  [[nodiscard]] Result<void> finish(Provenance provenance, SessionState state);

 private:
  [[nodiscard]] static Result<SessionFolder> create_numbered(const std::filesystem::path& folder,
                                                             const HostClocks& clocks);
  SessionFolder(std::filesystem::path folder, const HostClocks& clocks, std::shared_ptr<const FolderClaim> claim)
      : folder_(std::move(folder)), clock_(clocks), claim_(std::move(claim)) {}
  std::filesystem::path folder_;
  SessionClock clock_;
  std::shared_ptr<const FolderClaim> claim_;
};

/// Content of a session folder.
struct Session {
  Plan plan;
  PlanParts parts;  ///< descriptions that the plan names
  Provenance provenance;
  std::vector<Trial> trials;  ///< trials of the main curve
  std::vector<Trial> twin_trials;
  std::vector<Presentation> presentations;  ///< presentations of `trials`; empty in a session without targets.csv
  std::vector<Presentation> twin_presentations;
  std::optional<TodCurve> curve;  ///< fitted curve; empty if the run ended before the fit
  std::optional<TodCurve> twin;
  std::optional<Comparison> comparison;
  std::optional<SessionMeasures> measures;      ///< physical measures; empty if not requested
  std::optional<CurveUncertainty> uncertainty;  ///< uncertainty of `curve`; empty if the plan has no budget
  std::optional<Verdict> verdict;               ///< stored verdict; empty in older or cut-off sessions
  std::optional<CostFrontier> cost;             ///< accuracy against cost, if measured for this session
  /// Digest of the manifest that confirms these values (ManifestCheck); empty: no manifest confirms them.
  std::string manifest_sha256;
  /// Files that differ from the files that the run wrote. The files were read because the caller accepted changes.
  std::vector<std::string> accepted_changes;
  bool cut_off = false;  ///< no manifest: the values are not confirmed
  /// Returns false for a run that was interrupted or cut off.
  [[nodiscard]] bool complete() const { return provenance.state == SessionState::complete; }
};

/// Reads the files without a check against the manifest, for a session that is being written. All other readers use
/// open_session(). Errors: `invalid_input` (not a session folder; unreadable file, with path and line or key).
[[nodiscard]] Result<Session> read_session(const std::filesystem::path& folder);
/// Returns the reason for an early end of the run; empty if the run was complete.
[[nodiscard]] std::optional<std::string> ended_early(const Session& session);
/// Returns the stored verdict. If no verdict is stored, the function judges the session now, and Verdict::judged is
/// `afterwards`.
[[nodiscard]] Verdict verdict_of(const Session& session);
/// Stores a verdict that was made later, and lists it in the manifest. A run that was cut off has no manifest and stays
/// unchanged. Errors: `io` with the path.
[[nodiscard]] Result<void> keep_verdict(const std::filesystem::path& folder, const Verdict& verdict);

/// Returns curve.csv. With a budget, the last columns are the expanded intervals of the main curve.
[[nodiscard]] std::string curve_csv(const TodCurve& main, const std::optional<TodCurve>& twin, Side side,
                                    const std::optional<CurveUncertainty>& uncertainty = {});

}  // namespace todbench
