// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/replay.h"

#include <algorithm>

#include "acquisition/base/try.h"
#include "bench/run/recorded_bench.h"
#include "bench/session/fit_record.h"
#include "bench/session/trials_csv.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "bench/twin/module_chain.h"

namespace todbench {
namespace {

/// Reduces the trials to the columns of a file: earlier versions stored less of a trial.
std::vector<Trial> in_columns_of(std::vector<Trial> trials, std::string_view header) {
  for (Trial& trial : trials) {
    if (header.find("saturated_pixels") == std::string_view::npos) trial.saturated_pixels = 0;
    if (header.find("centroid_x_px") == std::string_view::npos) trial.centroid.reset();
    if (header.find("probability_correct") != std::string_view::npos) continue;
    trial.probability_correct.reset();
    trial.frames = 1;
  }
  return trials;
}

/// Compares files with different columns by their common columns.
Result<bool> same_as_far_as_known(const std::filesystem::path& then, std::string_view header,
                                  const std::filesystem::path& now, bool cut_off) {
  TODBENCH_TRY(const auto old_trials, read_trials(then));
  TODBENCH_TRY(const auto read, read_trials(now));
  const std::vector<Trial> trials = in_columns_of(read, header);
  const auto both = static_cast<std::ptrdiff_t>(std::min(trials.size(), old_trials.size()));
  return (cut_off || trials.size() == old_trials.size()) &&
         std::equal(trials.begin(), trials.begin() + both, old_trials.begin());
}

/// Compares files of trials. Frames and trials of an interrupted session may end at different points: they are compared
/// up to the earlier end.
Result<bool> same_trials(const std::filesystem::path& session, const std::filesystem::path& replay, bool cut_off) {
  TODBENCH_TRY(const auto then, read_text_file(session / "trials.csv"));
  TODBENCH_TRY(const auto now, read_text_file(replay / "trials.csv"));
  const auto header_of = [](const std::string& text) { return std::string_view(text).substr(0, text.find('\n')); };
  if (header_of(then) != header_of(now))
    return same_as_far_as_known(session / "trials.csv", header_of(then), replay / "trials.csv", cut_off);
  return now == then || (cut_off && (now.starts_with(then) || then.starts_with(now)));
}

/// Returns a curve without findings and reasons, which sessions of earlier versions do not have.
Result<Json> fits_of(TodCurve curve) {
  for (TodPoint& point : curve.points) {
    point.adequacy.reset();
    point.estimator_reason.reset();
    point.answers.reset();
  }
  return curve_record(curve);
}

/// Whether the intervals of a session follow the present rule: for graded answers of trials without places in the
/// picture, the intervals lack the share that set-ups have in common there.
Result<bool> comparable_fits(const std::filesystem::path& session, const TodCurve& curve) {
  const bool of_set_ups = std::ranges::any_of(
      curve.points, [](const TodPoint& point) { return point.fit.interval == IntervalKind::set_ups; });
  if (!of_set_ups) return true;
  TODBENCH_TRY(const auto trials, read_trials(session / "trials.csv"));
  return std::ranges::all_of(trials, [](const Trial& trial) { return trial.centroid.has_value(); });
}

}  // namespace

JudgedBy judged_by(const LoadedPlan& loaded) {
  const auto& sources = loaded.parts().sources;
  const auto source = sources.find({ResourceKind::observer, loaded.plan().observer});
  return {.observer = loaded.observer().name,
          .observer_sha256 = source == sources.end() ? "" : sha256_of(source->second.text),
          .package = "",
          .package_sha256 = ""};
}

Result<RecordedRun> open_recorded_run(const std::filesystem::path& session, const Pause* pause, const Opening& opening,
                                      RunModules modules) {
  // Frames and plan have to be those of the run.
  TODBENCH_TRY(auto recorded, open_session(session, opening));
  TODBENCH_TRY(auto recording, open_recorded_bench(session, pause));
  RecordedRun run{session, std::move(recorded), std::move(recording), {}, {}};
  run.plan = run.session.plan;
  // The author of a session chooses the programs that would run here.
  if (has_modules(run.plan, run.session.parts.sensor) && modules != RunModules::yes) {
    return fail(
        ErrorCode::invalid_input,
        session.string() + ": the session has a [[module]], and its program would run. Use --run-modules to allow it");
  }
  run.plan.measurement.record_frames = false;
  // The trials are repeated: physical measures are not taken again, so nothing could be held against their limits.
  const bool limits_left_out = !run.plan.limits.measures.empty() || !run.plan.limits.zones.empty();
  run.plan.measures = {};
  run.plan.limits.measures.clear();
  run.plan.limits.zones.clear();
  for (const std::string& file : run.session.accepted_changes)
    run.warnings.push_back("replayed from a session that was changed after its end: " + file);
  if (limits_left_out)
    run.warnings.emplace_back("limits on physical measures are left out: a replay repeats the trials");
  return run;
}

Result<ReplayOutcome> replay_session(const std::filesystem::path& session, const ExperimentOptions& options,
                                     const ExperimentListener& listener, std::stop_token stop, const Opening& opening,
                                     RunModules modules) {
  TODBENCH_TRY(auto recorded,
               open_recorded_run(session, options.host.pause,
                                 {.accept_changed = opening.accept_changed, .accept_cut_off = true}, modules));
  const Session& then = recorded.session;
  TODBENCH_TRY(const auto loaded, LoadedPlan::of(recorded.plan, then.parts));
  EffectPlanner planner;
  TODBENCH_TRY(auto inputs, experiment_inputs(loaded, planner));
  inputs.warnings.insert(inputs.warnings.end(), recorded.warnings.begin(), recorded.warnings.end());
  auto run = measure_on_bench(loaded, inputs, std::move(recorded.recording.bench), options, listener, std::move(stop));
  // A measurement that asked other questions is not a replay.
  TODBENCH_TRY_VOID(recorded.recording.answers->agreed());
  if (!run) return tl::unexpected(run.error());

  const bool cut_off = then.cut_off;
  TODBENCH_TRY(auto trials, same_trials(session, run->folder, cut_off));
  ReplayOutcome outcome{.run = *std::move(run), .same_trials = trials, .same_fits = std::nullopt};
  outcome.accepted_changes = then.accepted_changes;
  if (!then.curve) return outcome;
  TODBENCH_TRY(const auto comparable, comparable_fits(session, *then.curve));
  if (!comparable) return outcome;
  const auto fits_then = fits_of(*then.curve), fits_now = fits_of(outcome.run.curve);
  if (!fits_then || !fits_now) return tl::unexpected(fits_then ? fits_now.error() : fits_then.error());
  outcome.same_fits = *fits_then == *fits_now;
  return outcome;
}

}  // namespace todbench
