// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/session_end.h"

#include <utility>

#include "acquisition/base/try.h"
#include "bench/judgement/run_findings.h"
#include "bench/report/report.h"
#include "bench/report/report_csv.h"
#include "bench/run/report_data.h"
#include "bench/session/ending_reserve.h"
#include "bench/session/manifest.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

/// Stores the first error of the disk.
class Refusals {
 public:
  void keep(const Result<void>& written) {
    if (!written && !first_) first_ = written.error();
  }
  [[nodiscard]] const std::optional<Error>& first() const { return first_; }

 private:
  std::optional<Error> first_;
};

/// Report data of all files in the folder except the manifest.
Result<ReportData> report_of(const SessionFolder& folder, const ManifestEntries& entries) {
  TODBENCH_TRY(auto session, read_session(folder.path()));
  session.manifest_sha256 = digest_of(entries);
  return report_data(session, session_name(folder.path()));
}

/// Writes page and table, and adds each to the manifest if it was written.
void write_report_of(SessionFolder& folder, ManifestEntries& entries, Refusals& refused) {
  const auto data = report_of(folder, entries);
  if (!data) return refused.keep(tl::unexpected(data.error()));
  const std::pair<const char*, Result<void>> pages[] = {
      {"report.html", folder.write_report(render_report(*data))},
      {"report.csv", write_file_atomically(folder.path() / "report.csv", report_csv(*data))}};
  for (const auto& [name, written] : pages) {
    refused.keep(written);
    if (written) refused.keep(update_entries(folder.path(), {name}, entries));
  }
}

/// Completes the provenance at the end of a run.
Provenance ended(Provenance provenance, const SessionClock& clock, const std::optional<Error>& ended_by) {
  provenance.state = ended_by ? SessionState::interrupted : SessionState::complete;
  provenance.ended_utc = clock.now_utc();
  provenance.clock_jump_s = clock.jump_s();
  if (ended_by && provenance.run && provenance.run->ended_by.empty()) provenance.run->ended_by = ended_by->message;
  return provenance;
}

/// Share of the contrast that the size-of-source effect takes from the smallest triangles that measure contrasts,
/// beyond that of the twin, whose response is corrected. Empty: not measured, or contrasts in grey levels.
std::optional<double> loss_of_triangles(const ExperimentOutcome& outcome, const Plan& plan) {
  if (plan.camera.contrast != ContrastUnit::kelvin || !outcome.measures || !outcome.measures->source)
    return std::nullopt;
  const auto loss_in = [&](const std::optional<CameraMeasures>& measures) {
    return measures && measures->source ? measures->source->effect.loss(plan.measurement.min_reference_px).value : 0;
  };
  return loss_in(outcome.measures) - loss_in(outcome.twin_measures);
}

}  // namespace

Result<void> close_session(const OpenSession& open, const Provenance& provenance, const Verdict& verdict,
                           const std::optional<Error>& ended_by) {
  SessionFolder& folder = open.folder;
  Refusals refused;
  free_ending_room(folder.path(), EndingRoom::state);
  const Provenance last = ended(provenance, folder.clock(), ended_by);
  if (last.clock_jump_s != 0) note(folder, open.listener, jump_sentence(last.clock_jump_s));
  refused.keep(folder.log(ended_by ? "ended early: " + ended_by->message : "complete"));
  refused.keep(folder.write_provenance(last));
  refused.keep(folder.write_verdict(verdict));
  auto entries = manifest_entries(folder.path());
  if (!entries) {
    refused.keep(tl::unexpected(entries.error()));
  } else if (last.run) {
    write_report_of(folder, *entries, refused);
  }
  free_ending_room(folder.path(), EndingRoom::manifest);
  if (entries) refused.keep(write_manifest(folder.path(), *entries));
  if (refused.first()) return tl::unexpected(*refused.first());
  return {};
}

void phase(SessionFolder& folder, const ExperimentListener& listener, const std::string& text) {
  (void)folder.log(text);
  if (listener.on_phase) listener.on_phase(text);
}

void note(SessionFolder& folder, const ExperimentListener& listener, const std::string& sentence) {
  (void)folder.log(sentence);
  if (listener.on_note) listener.on_note(sentence);
}

Result<SessionFolder> begin_session(const LoadedPlan& loaded, const ExperimentOptions& options,
                                    Provenance& provenance) {
  auto folder = SessionFolder::create(options.folder, options.existing, options.host.clocks);
  if (!folder) return folder;
  provenance.started_utc = folder->clock().started_utc();
  provenance.selftest = kept_selftest(selftest_file());
  auto begun = take_ending_rooms(folder->path());
  if (begun) begun = folder->write_plan(loaded);
  if (begun) begun = folder->write_provenance(provenance);
  if (begun) return folder;
  free_ending_rooms(folder->path());
  return tl::unexpected(begun.error());
}

void note_failed_selftest(const OpenSession& open, const Provenance& provenance) {
  if (!provenance.selftest || provenance.selftest->failed == 0) return;
  note(open.folder, open.listener,
       "the last self-test of this program on this computer failed: " + in_words(*provenance.selftest));
}

tl::unexpected<Error> abandon(const OpenSession& open, const Plan& plan, const Provenance& provenance, Error error) {
  free_ending_room(open.folder.path(), EndingRoom::results);
  const Verdict verdict =
      judge({.limits = plan.limits, .curve = {}, .comparison = std::nullopt, .ended_early = error.message});
  (void)close_session(open, provenance, verdict, error);
  return tl::unexpected<Error>(std::move(error));
}

ExperimentOutcome concluded(ExperimentOutcome outcome, const Plan& plan, const OpenSession& open,
                            const Provenance& provenance) {
  Refusals refused;
  free_ending_room(open.folder.path(), EndingRoom::results);
  auto uncertainty = curve_uncertainty(plan, outcome.curve, outcome.presentations, outcome.comparison,
                                       loss_of_triangles(outcome, plan));
  if (uncertainty)
    outcome.uncertainty = *std::move(uncertainty);
  else if (!outcome.ended_by)
    outcome.ended_by = uncertainty.error();
  refused.keep(open.folder.write_curves(outcome.curve, outcome.twin, provenance.side, outcome.uncertainty));
  if (outcome.comparison) refused.keep(open.folder.write_comparison(*outcome.comparison));
  if (outcome.measures || outcome.twin_measures)
    refused.keep(open.folder.write_measures(outcome.measures, outcome.twin_measures));
  if (!outcome.ended_by) outcome.ended_by = refused.first();
  // A simulated curve has no twin: equivalence to one is not demanded of it.
  LimitsPlan limits = plan.limits;
  if (!provenance.camera) limits.equivalence_margin_percent.reset();
  outcome.verdict = judge(
      {.limits = limits,
       .curve = outcome.curve,
       .comparison = outcome.comparison,
       .ended_early = outcome.ended_by ? std::optional(outcome.ended_by->message) : std::nullopt,
       .bench_contradicts = outcome.ended_by && outcome.ended_by->code == ErrorCode::calibration,
       .uncertainty = outcome.uncertainty ? &*outcome.uncertainty : nullptr,
       .air_transmittance = provenance.camera ? contrast_transmittance(plan, outcome.presentations) : std::nullopt,
       .measures = outcome.measures ? std::optional(quantities_of(measure_lines(*outcome.measures))) : std::nullopt});
  auto closed = close_session(open, provenance, outcome.verdict, outcome.ended_by);
  if (!closed && !outcome.ended_by) outcome.ended_by = closed.error();
  return outcome;
}

}  // namespace todbench
