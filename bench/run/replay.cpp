#include "bench/run/replay.h"

#include <algorithm>

#include "bench/run/module_chain.h"
#include "bench/run/recorded_bench.h"
#include "bench/session/fit_record.h"
#include "bench/session/trials_csv.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// The trials as the columns of a file know them: an earlier version kept less of a trial.
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

/// The same of files with other columns: what both know.
Result<bool> same_as_far_as_known(const std::filesystem::path& then, std::string_view header,
                                  const std::filesystem::path& now, bool cut_off) {
  const auto old_trials = read_trials(then);
  if (!old_trials) return tl::unexpected(old_trials.error());
  const auto read = read_trials(now);
  if (!read) return tl::unexpected(read.error());
  const std::vector<Trial> trials = in_columns_of(*read, header);
  const auto both = static_cast<std::ptrdiff_t>(std::min(trials.size(), old_trials->size()));
  return (cut_off || trials.size() == old_trials->size()) &&
         std::equal(trials.begin(), trials.begin() + both, old_trials->begin());
}

/// Equal files; of a session that was cut off, in which frames and trials need not end together, equal as far as both
/// go.
Result<bool> same_trials(const std::filesystem::path& session, const std::filesystem::path& replay, bool cut_off) {
  const auto then = read_text_file(session / "trials.csv");
  if (!then) return tl::unexpected(then.error());
  const auto now = read_text_file(replay / "trials.csv");
  if (!now) return tl::unexpected(now.error());
  const auto header_of = [](const std::string& text) { return std::string_view(text).substr(0, text.find('\n')); };
  if (header_of(*then) != header_of(*now))
    return same_as_far_as_known(session / "trials.csv", header_of(*then), replay / "trials.csv", cut_off);
  return *now == *then || (cut_off && (now->starts_with(*then) || then->starts_with(*now)));
}

/// A curve without what is said of it: a session of an earlier program knows no findings and no reasons.
Json fits_of(TodCurve curve) {
  for (TodPoint& point : curve.points) {
    point.adequacy.reset();
    point.estimator_reason.reset();
    point.answers.reset();
  }
  return curve_record(curve);
}

/// Whether the intervals of a session were made by the same rule: graded answers whose trials do not say where they
/// were in the picture have intervals without what set-ups share there.
Result<bool> comparable_fits(const std::filesystem::path& session, const TodCurve& curve) {
  const bool of_set_ups = std::ranges::any_of(
      curve.points, [](const TodPoint& point) { return point.fit.interval == IntervalKind::set_ups; });
  if (!of_set_ups) return true;
  const auto trials = read_trials(session / "trials.csv");
  if (!trials) return tl::unexpected(trials.error());
  return std::ranges::all_of(*trials, [](const Trial& trial) { return trial.centroid.has_value(); });
}

}  // namespace

Result<ReplayOutcome> replay_session(const std::filesystem::path& session, const ExperimentOptions& options,
                                     const ExperimentListener& listener, std::stop_token stop, const Opening& opening,
                                     RunModules modules) {
  // Frames and plan have to be those of the run.
  auto recorded = open_session(session, {.accept_changed = opening.accept_changed, .accept_cut_off = true});
  if (!recorded) return tl::unexpected(recorded.error());
  auto recording = open_recorded_bench(session, options.host.pause);
  if (!recording) return tl::unexpected(recording.error());
  Plan plan = recorded->plan;
  // Whoever made a session says in it what would run here.
  if (has_modules(plan, recorded->parts.sensor) && modules != RunModules::yes) {
    return fail(ErrorCode::invalid_input,
                session.string() + ": has a [[module]], a program that would run here: --run-modules lets it");
  }
  plan.measurement.record_frames = false;
  plan.measures = {};  // a replay repeats the trials
  const auto loaded = LoadedPlan::of(std::move(plan), recorded->parts);
  if (!loaded) return tl::unexpected(loaded.error());
  EffectPlanner planner;
  auto inputs = experiment_inputs(*loaded, planner);
  if (!inputs) return tl::unexpected(inputs.error());
  for (const std::string& file : recorded->accepted_changes)
    inputs->warnings.push_back("replayed from a session that was changed after it had ended: " + file);
  auto run = measure_on_bench(*loaded, *inputs, std::move(recording->bench), options, listener, std::move(stop));
  // What was measured with answers to other questions is no replay.
  if (auto agreed = recording->answers->agreed(); !agreed) return tl::unexpected(agreed.error());
  if (!run) return tl::unexpected(run.error());

  const bool cut_off = recorded->cut_off;
  auto trials = same_trials(session, run->folder, cut_off);
  if (!trials) return tl::unexpected(trials.error());
  ReplayOutcome outcome{.run = *std::move(run), .same_trials = *trials, .same_fits = std::nullopt};
  outcome.accepted_changes = recorded->accepted_changes;
  if (!recorded->curve) return outcome;
  const auto comparable = comparable_fits(session, *recorded->curve);
  if (!comparable) return tl::unexpected(comparable.error());
  if (*comparable) outcome.same_fits = fits_of(*recorded->curve) == fits_of(outcome.run.curve);
  return outcome;
}

}  // namespace todbench
