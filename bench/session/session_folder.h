// A session: the folder that a run leaves behind, written so that it is valid at every moment, and read back into
// values.
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

/// What to do with a folder that is not empty.
enum class ExistingFolder {
  refuse,
  overwrite,  ///< removes the files of an earlier session, never anything else
  number,     ///< takes a new folder beside it, with -2, -3, ... behind the name
};

/// "session-20260131T123456Z-NAME" with the time of now; a second one within the same second needs a number.
[[nodiscard]] std::string session_folder_name(const std::string& plan_name);

/// Which of the two curves of a session: the one that the session is about, or its simulated twin.
enum class SessionCurve { main, twin };

/// Writes a session. Everything but trials, targets and log is written atomically. One thread at a time. Nobody else
/// begins a session in the folder until the last copy of this value is gone.
/// Every function fails with `io` and the path when the disk refuses.
class SessionFolder {
 public:
  /// Creates the folder with its parents; the session begins now. `invalid_input` when it exists, is not empty and may
  /// not be overwritten, when another session is being written into it, or when it is a file or below one. `io` when it
  /// cannot be created or written to.
  [[nodiscard]] static Result<SessionFolder> create(const std::filesystem::path& folder, ExistingFolder existing,
                                                    const HostClocks& clocks = host_clocks());

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  [[nodiscard]] const SessionClock& clock() const { return clock_; }
  /// session.toml; the plates, sensor, observer and letterhead used are copied to inputs/, and references to files
  /// point there. References to built-in descriptions stay names.
  [[nodiscard]] Result<void> write_plan(const LoadedPlan& loaded);
  /// provenance.json. Written with state running at the start and again whenever more is known.
  [[nodiscard]] Result<void> write_provenance(const Provenance& provenance);
  /// trials.csv or trials_simulated.csv.
  [[nodiscard]] Result<TrialsWriter> open_trials(SessionCurve which);
  /// targets.csv or targets_simulated.csv.
  [[nodiscard]] Result<TargetsWriter> open_targets(SessionCurve which);
  /// fits.json, curve.csv and, with a budget of the main curve, uncertainty.json.
  [[nodiscard]] Result<void> write_curves(const TodCurve& main, const std::optional<TodCurve>& twin, Side side,
                                          const std::optional<CurveUncertainty>& uncertainty = {});
  /// comparison.json.
  [[nodiscard]] Result<void> write_comparison(const Comparison& comparison);
  /// grey-levels.csv: contrast and signal transfer of every frame that was judged.
  [[nodiscard]] Result<void> write_grey_levels(const std::vector<GreyFrame>& frames);
  /// measures.json, and its pictures in pictures/.
  [[nodiscard]] Result<void> write_measures(const std::optional<CameraMeasures>& main,
                                            const std::optional<CameraMeasures>& twin);
  /// The same of a record as measures_json() makes it.
  [[nodiscard]] Result<void> write_measures(Json record);
  /// verdict.json.
  [[nodiscard]] Result<void> write_verdict(const Verdict& verdict);
  /// report.html.
  [[nodiscard]] Result<void> write_report(std::string_view html);
  /// One line in log.txt, with the time of the session's clock.
  [[nodiscard]] Result<void> log(std::string_view sentence);
  /// Writes provenance with `state` and, where it has no end yet, the time, then the manifest. To be called last, also
  /// when interrupted.
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

/// A session as values.
struct Session {
  Plan plan;
  PlanParts parts;  ///< what the plan names
  Provenance provenance;
  std::vector<Trial> trials;  ///< of the main curve
  std::vector<Trial> twin_trials;
  std::vector<Presentation> presentations;  ///< those of `trials`; empty in a session without targets.csv
  std::vector<Presentation> twin_presentations;
  std::optional<TodCurve> curve;  ///< as it was fitted; nothing where the run ended before
  std::optional<TodCurve> twin;
  std::optional<Comparison> comparison;
  std::optional<SessionMeasures> measures;      ///< physical; nothing where none was asked for
  std::optional<CurveUncertainty> uncertainty;  ///< of `curve`; nothing where the plan has no budget
  std::optional<Verdict> verdict;    ///< as it was stored; nothing in an old session, or where the run was cut off
  std::optional<CostFrontier> cost;  ///< what accuracy costs, where it was measured for this session
  /// Of the manifest that vouches for these values (ManifestCheck); empty where none does.
  std::string manifest_sha256;
  /// Files that are not those that the run wrote and were read nevertheless, because somebody asked for it.
  std::vector<std::string> accepted_changes;
  bool cut_off = false;  ///< no manifest: nothing vouches for these values
  /// False when the run was interrupted or cut off.
  [[nodiscard]] bool complete() const { return provenance.state == SessionState::complete; }
};

/// The files as they are. For a session that is being written; every other reader has to know whether they are those
/// that the run wrote, so it takes open_session(). `invalid_input`: not a session folder, or a file in it that cannot
/// be read, with its path and line or key.
[[nodiscard]] Result<Session> read_session(const std::filesystem::path& folder);
/// Why the run of a session ended early; nothing when it came to its end.
[[nodiscard]] std::optional<std::string> ended_early(const Session& session);
/// The verdict to show: the stored one. A session without one is judged, and the verdict says so.
[[nodiscard]] Verdict verdict_of(const Session& session);
/// Stores a verdict that was made afterwards, and lists it in the manifest. A run that was cut off has no manifest and
/// stays as it is. `io` with the path.
[[nodiscard]] Result<void> keep_verdict(const std::filesystem::path& folder, const Verdict& verdict);

/// curve.csv. With a budget the expanded intervals of the main curve stand in columns of their own, the last ones.
[[nodiscard]] std::string curve_csv(const TodCurve& main, const std::optional<TodCurve>& twin, Side side,
                                    const std::optional<CurveUncertainty>& uncertainty = {});

}  // namespace todbench
