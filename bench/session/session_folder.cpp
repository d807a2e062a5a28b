// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/session_folder.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <system_error>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/try.h"
#include "bench/judgement/run_findings.h"
#include "bench/judgement/verdict_record.h"
#include "bench/plan/plan_options.h"
#include "bench/plan/strict_toml.h"
#include "bench/session/cost_record.h"
#include "bench/session/ending_reserve.h"
#include "bench/session/fit_record.h"
#include "bench/session/foreign_files.h"
#include "bench/session/grey_levels_csv.h"
#include "bench/session/kept_bars_record.h"
#include "bench/session/measure_pictures.h"
#include "bench/session/signature.h"
#include "bench/session/uncertainty_record.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_fields.h"
#include "bench/text/json_file.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {

namespace {

std::filesystem::path trials_file(const std::filesystem::path& folder, SessionCurve which) {
  return folder / (which == SessionCurve::main ? "trials.csv" : "trials_simulated.csv");
}

std::filesystem::path targets_file(const std::filesystem::path& folder, SessionCurve which) {
  return folder / (which == SessionCurve::main ? "targets.csv" : "targets_simulated.csv");
}

/// Removes temporary files of a program that was killed.
Result<void> remove_parts(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> parts;
  std::error_code problem;
  for (const char* within : {"", "inputs", "pictures", "frames"}) {
    for (auto entry = std::filesystem::directory_iterator(folder / within, problem);
         !problem && entry != std::filesystem::directory_iterator(); entry.increment(problem)) {
      if (is_name_of_a_part(entry->path())) parts.push_back(entry->path());
    }
  }
  for (const std::filesystem::path& part : parts) {
    if (!std::filesystem::remove(part, problem) && problem)
      return fail(ErrorCode::io, part.string() + ": cannot be removed: " + problem.message());
  }
  return {};
}

Result<void> remove_session_files(const std::filesystem::path& folder) {
  free_ending_rooms(folder);
  std::vector<std::string> files = session_files(folder);
  files.emplace_back("manifest.json");
  for (const std::string& file : files) {
    std::error_code problem;
    std::filesystem::remove(folder / file, problem);
    if (problem) return fail(ErrorCode::io, (folder / file).string() + ": cannot be removed: " + problem.message());
  }
  return remove_parts(folder);
}

/// Copies of descriptions in inputs/, each with a unique name.
class InputCopies {
 public:
  explicit InputCopies(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Copies a description and returns the reference for session.toml.
  Result<std::string> copy(ResourceKind kind, const std::string& reference, const std::string& text) {
    const std::string stem = std::string(to_string(kind)) + "-" + std::filesystem::path(reference).stem().string();
    std::string name = stem + ".toml";
    for (int i = 2; !used_.insert(name).second; ++i) name = stem + "-" + std::to_string(i) + ".toml";
    std::error_code problem;
    std::filesystem::create_directories(folder_ / "inputs", problem);
    if (problem)
      return fail(ErrorCode::io, (folder_ / "inputs").string() + ": cannot be created: " + problem.message());
    if (const Result<void> written = write_file_atomically(folder_ / "inputs" / name, text); !written) {
      return tl::unexpected(written.error());
    }
    return is_file_reference(reference) ? "inputs/" + name : reference;
  }

 private:
  std::filesystem::path folder_;
  std::set<std::string> used_;
};

std::string csv_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? number_text(*value) : "";
}

/// Appends the last columns: expanded intervals and standard uncertainty of ln acuity.
void add_expanded(std::string& text, const PointUncertainty* found) {
  if (found == nullptr) {
    text += ",,,,,";
    return;
  }
  const Interval acuity = acuity_interval(found->expanded_mrad);
  for (const std::optional<double>& value :
       {found->expanded_mrad.low, found->expanded_mrad.high, acuity.low, acuity.high,
        found->combined ? std::optional(found->combined->u) : std::nullopt}) {
    text += "," + csv_number(value);
  }
}

/// Appends the rows of a curve. For a curve without a budget `uncertainty` has no points.
void add_rows(std::string& text, const TodCurve& curve, Side side, const std::optional<CurveUncertainty>& uncertainty) {
  for (const TodPoint& point : curve.points) {
    const Interval acuity = acuity_interval(point.fit.ci95);
    text += to_string(side);
    for (const std::optional<double>& value :
         {std::optional(point.set_delta_t_k), std::optional(point.delta_t_k), contrast_se_k(point),
          stated_threshold(point.fit), point.fit.ci95.low, point.fit.ci95.high, stated_acuity_per_mrad(point.fit),
          acuity.low, acuity.high, point.fit.slope, std::optional(point.fit.lapse), std::optional(point.fit.trials),
          point.direct_s75_mrad, point.direct_s75_se_mrad}) {
      text += "," + csv_number(value);
    }
    text += "," + std::string(to_string(point.fit.verdict));
    if (uncertainty) add_expanded(text, point_at(*uncertainty, point.set_delta_t_k));
    text += "\n";
  }
}

/// Appends the rows of a continuous curve: side "continuous", without the columns of a fit.
void add_continuous(std::string& text, const TodCurve& curve, const std::optional<CurveUncertainty>& uncertainty) {
  for (const ContinuousPoint& point : curve.continuous) {
    const Interval acuity = acuity_interval(point.ci95);
    text += "continuous";
    for (const std::optional<double>& value :
         {std::optional(point.delta_t_k), std::optional(point.delta_t_k), std::optional<double>(),
          std::optional(point.s75_mrad), point.ci95.low, point.ci95.high, std::optional(1 / point.s75_mrad), acuity.low,
          acuity.high, std::optional<double>(), std::optional<double>(), std::optional<double>(),
          std::optional<double>(), std::optional<double>()}) {
      text += "," + csv_number(value);
    }
    text += ",";
    if (uncertainty) add_expanded(text, nullptr);
    text += "\n";
  }
}

/// Reads an optional record.
template <typename T>
Result<std::optional<T>> read_record(const std::filesystem::path& file, Result<T> (*from)(const Json&)) {
  if (!is_there(file)) return std::nullopt;
  TODBENCH_TRY(const Json json, read_json_file(file));
  Result<T> record = from(json);
  if (!record) return fail(file.string(), record.error());
  return *std::move(record);
}

/// Reads measures.json with its pictures.
Result<std::optional<SessionMeasures>> read_measures(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "measures.json";
  if (!is_there(file)) return std::nullopt;
  TODBENCH_TRY(const Json record, read_json_file(file));
  const Result<Json> whole = with_pictures(record, folder);
  if (!whole) return fail(file.string(), whole.error());
  auto measures = measures_from(*whole);
  if (!measures) return fail(file.string(), measures.error());
  return *std::move(measures);
}

Result<void> read_all_trials(const std::filesystem::path& folder, Session& session) {
  for (const auto& [which, target] :
       {std::pair(SessionCurve::main, &session.trials), std::pair(SessionCurve::twin, &session.twin_trials)}) {
    const std::filesystem::path file = trials_file(folder, which);
    if (!is_there(file)) continue;
    TODBENCH_TRY(*target, read_trials(file));
  }
  return {};
}

Result<void> read_all_targets(const std::filesystem::path& folder, Session& session) {
  for (const auto& [which, target] : {std::pair(SessionCurve::main, &session.presentations),
                                      std::pair(SessionCurve::twin, &session.twin_presentations)}) {
    const std::filesystem::path file = targets_file(folder, which);
    if (!is_there(file)) continue;
    TODBENCH_TRY(*target, read_targets(file));
  }
  return {};
}

}  // namespace

std::string session_folder_name(const std::string& plan_name) {
  std::string stamp;
  for (const char c : utc_now()) {
    if (c != '-' && c != ':') stamp += c;
  }
  std::string clean;
  for (const char c : plan_name)
    clean += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
  return "session-" + stamp + "-" + clean;
}

Result<SessionFolder> SessionFolder::create(const std::filesystem::path& folder, ExistingFolder existing,
                                            const HostClocks& clocks) {
  if (existing == ExistingFolder::number) return create_numbered(folder, clocks);
  std::error_code problem;
  if (std::filesystem::exists(folder, problem) && !std::filesystem::is_directory(folder, problem)) {
    return fail(ErrorCode::invalid_input, folder.string() + ": expected a folder, found a file");
  }
  TODBENCH_TRY_VOID(make_folder(folder));
  TODBENCH_TRY(auto claim, claim_folder(folder));
  const bool empty = std::filesystem::is_empty(folder, problem);
  if (problem) return fail(code_of_path(problem), folder.string() + ": cannot be read: " + problem.message());
  if (!empty && existing == ExistingFolder::refuse) {
    return fail(ErrorCode::invalid_input,
                folder.string() + ": the folder is not empty. Choose another one or overwrite it with --force");
  }
  TODBENCH_TRY_VOID(require_unsigned(folder));
  TODBENCH_TRY_VOID(require_no_links(folder));
  TODBENCH_TRY_VOID(remove_session_files(folder));
  return SessionFolder(folder, clocks, std::move(claim));
}

Result<SessionFolder> SessionFolder::create_numbered(const std::filesystem::path& folder, const HostClocks& clocks) {
  std::filesystem::path name = folder;
  for (int number = 2;; ++number) {
    std::error_code problem;
    // create_directory succeeds in only one of several programs.
    if (std::filesystem::create_directory(name, problem)) {
      TODBENCH_TRY(auto claim, claim_folder(name));
      return SessionFolder(name, clocks, std::move(claim));
    }
    if (problem && problem != std::errc::file_exists)
      return fail(code_of_path(problem), name.string() + ": cannot be created: " + problem.message());
    name = folder.string() + "-" + std::to_string(number);
  }
}

Result<void> SessionFolder::write_plan(const LoadedPlan& loaded) {
  Plan stored = loaded.plan();
  InputCopies copies(folder_);
  std::vector<std::pair<ResourceKind, std::string*>> references{{ResourceKind::observer, &stored.observer},
                                                                {ResourceKind::sensor, &stored.simulation.sensor}};
  for (const MeasurePlate& plate : measure_plates) {
    if (stored.measures.*plate.requested)
      references.emplace_back(ResourceKind::plate, &(stored.measures.*plate.reference));
  }
  for (std::string& plate : stored.target.plates) references.emplace_back(ResourceKind::plate, &plate);
  if (stored.target.kind == TargetKind::scpi) {
    references.emplace_back(ResourceKind::black_body, &stored.target.black_body_table);
    references.emplace_back(ResourceKind::stage, &stored.target.stage_table);
  }
  for (const auto& [kind, reference] : references) {
    TODBENCH_TRY(*reference, copies.copy(kind, *reference, loaded.parts().sources.at({kind, *reference}).text));
  }
  if (loaded.parts().letterhead) {
    TODBENCH_TRY_VOID(keep_letterhead(folder_, *loaded.parts().letterhead));
    stored.report.letterhead = letterhead_file;
  }
  return write_file_atomically(folder_ / "session.toml", to_toml(stored));
}

Result<void> SessionFolder::write_provenance(const Provenance& provenance) {
  return write_json_file(folder_ / "provenance.json", provenance_json(provenance));
}

Result<TrialsWriter> SessionFolder::open_trials(SessionCurve which) {
  return TrialsWriter::create(trials_file(folder_, which));
}

Result<TargetsWriter> SessionFolder::open_targets(SessionCurve which) {
  return TargetsWriter::create(targets_file(folder_, which));
}

Result<void> SessionFolder::write_curves(const TodCurve& main, const std::optional<TodCurve>& twin, Side side,
                                         const std::optional<CurveUncertainty>& uncertainty) {
  if (auto written = write_json_file(folder_ / "fits.json", curves_record({main, twin})); !written) return written;
  if (uncertainty) {
    TODBENCH_TRY_VOID(write_json_file(folder_ / "uncertainty.json", uncertainty_record(*uncertainty)));
  }
  return write_file_atomically(folder_ / "curve.csv", curve_csv(main, twin, side, uncertainty));
}

Result<void> SessionFolder::write_comparison(const Comparison& comparison) {
  return write_json_file(folder_ / "comparison.json", comparison_record(comparison));
}

Result<void> SessionFolder::write_grey_levels(const std::vector<GreyFrame>& frames) {
  return write_file_atomically(folder_ / "grey-levels.csv", grey_levels_csv(frames));
}

Result<void> SessionFolder::write_measures(const std::optional<CameraMeasures>& main,
                                           const std::optional<CameraMeasures>& twin) {
  if (main && main->mrtd && !main->mrtd->kept.pictures.empty()) {
    TODBENCH_TRY_VOID(write_kept_bars(folder_, main->mrtd->kept));
  }
  return write_measures(measures_record(main, twin));
}

Result<void> SessionFolder::write_measures(Result<Json> record) {
  const std::filesystem::path file = folder_ / "measures.json";
  if (!record) return fail(file.string(), record.error());
  const std::vector<MeasurePicture> pictures = take_pictures(*record);
  if (!pictures.empty()) {
    std::error_code problem;
    std::filesystem::create_directories(folder_ / pictures_folder, problem);
    if (problem)
      return fail(ErrorCode::io, (folder_ / pictures_folder).string() + ": cannot be created: " + problem.message());
  }
  for (const MeasurePicture& picture : pictures) {
    TODBENCH_TRY_VOID(write_file_atomically(folder_ / picture.file, picture.png));
  }
  return write_file_atomically(file, to_page(*record));
}

Result<void> SessionFolder::write_verdict(const Verdict& verdict) {
  return write_json_file(folder_ / "verdict.json", verdict_record(verdict));
}

Result<void> SessionFolder::write_report(std::string_view html) {
  return write_file_atomically(folder_ / "report.html", html);
}

Result<void> SessionFolder::log(std::string_view sentence) {
  TODBENCH_TRY(AppendFile file, AppendFile::open(folder_ / "log.txt", AppendFile::Start::at_end));
  return file.append(clock_.now_utc() + " " + one_line(sentence) + "\n");
}

Result<void> SessionFolder::finish(Provenance provenance, SessionState state) {
  provenance.state = state;
  if (provenance.ended_utc.empty()) provenance.ended_utc = clock_.now_utc();
  TODBENCH_TRY_VOID(write_provenance(provenance));
  return write_manifest(folder_);
}

std::string curve_csv(const TodCurve& main, const std::optional<TodCurve>& twin, Side side,
                      const std::optional<CurveUncertainty>& uncertainty) {
  std::string text =
      "side,set_delta_t_k,delta_t_k,delta_t_se_k,s75_mrad,s75_ci95_low_mrad,s75_ci95_high_mrad,acuity_per_mrad,"
      "acuity_ci95_low_per_mrad,acuity_ci95_high_per_mrad,slope,lapse,trials,s75_direct_mrad,s75_direct_se_mrad,"
      "verdict";
  if (uncertainty) {
    text +=
        ",s75_expanded95_low_mrad,s75_expanded95_high_mrad,acuity_expanded95_low_per_mrad,"
        "acuity_expanded95_high_per_mrad,u_ln_acuity";
  }
  text += "\n";
  add_rows(text, main, side, uncertainty);
  if (twin) add_rows(text, *twin, Side::simulated, uncertainty ? std::optional(CurveUncertainty{}) : std::nullopt);
  add_continuous(text, main, uncertainty);
  return text;
}

namespace {

/// Sets the options that an earlier version did not have to its fixed behaviour: binary answers to one frame each and a
/// Weibull function. An adaptive schedule with automatic answers gets the kind found in its trials.
Result<void> keep_as_it_was(Plan& plan, std::span<const Trial> trials, const std::filesystem::path& file) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  TODBENCH_TRY(auto reader, TomlReader::parse(text, file.string()));
  if (!reader.section("fit").has("estimator")) plan.fit.estimator = EstimatorChoice::weibull;
  TomlReader schedule = reader.section("schedule");
  const auto is_graded = [](const Trial& trial) { return trial.probability_correct.has_value(); };
  const bool left_open =
      plan.schedule.kind == ScheduleKind::adaptive && plan.schedule.answers == AnswersChoice::automatic;
  if (!schedule.has("answers") || (left_open && std::ranges::none_of(trials, is_graded)))
    plan.schedule.answers = AnswersChoice::binary;
  std::vector<int>& frames = plan.schedule.frames_per_presentation;
  if (!schedule.has("frames_per_presentation"))
    frames = {1};
  else if (plan.schedule.answers != AnswersChoice::binary)
    std::ranges::replace(frames, 0, frames_of_graded_answers);  // value in a session without a chosen number
  return {};
}

/// targets.csv states set-points; the points of the curve to which they belong are in the trials.
void restore_own_contrasts(Session& session) {
  const bool ramp = session.plan.schedule.kind == ScheduleKind::ramp;
  if (!ramp && !(session.plan.target.contrast_settling_band_percent > 0)) return;
  std::map<std::int64_t, double> points;
  for (const Trial& trial : session.trials) points[trial.presentation] = trial.set_delta_t_k;
  for (Presentation& shown : session.presentations) {
    shown.set.wait = ramp ? ContrastWait::none : ContrastWait::within_band;
    const auto point = points.find(shown.presentation);
    if (ramp && point != points.end()) shown.set.point_delta_t_k = point->second;
  }
}

}  // namespace

Result<Session> read_session(const std::filesystem::path& folder) {
  if (!is_there(folder / "session.toml")) {
    return fail(ErrorCode::invalid_input, folder.string() + ": not a session folder (there is no session.toml)");
  }
  Session session;
  TODBENCH_TRY(const LoadedPlan loaded, read_plan((folder / "session.toml").string()));
  session.plan = loaded.plan();
  session.parts = loaded.parts();

  const std::filesystem::path provenance_file = folder / "provenance.json";
  TODBENCH_TRY(const Json provenance_text, read_json_file(provenance_file));
  Result<Provenance> provenance = provenance_from(provenance_text);
  if (!provenance) return fail(provenance_file.string(), provenance.error());
  session.provenance = *std::move(provenance);

  TODBENCH_TRY_VOID(read_all_trials(folder, session));
  TODBENCH_TRY_VOID(keep_as_it_was(session.plan, session.trials, folder / "session.toml"));
  TODBENCH_TRY_VOID(read_all_targets(folder, session));
  restore_own_contrasts(session);
  TODBENCH_TRY(auto curves, read_record(folder / "fits.json", curves_from));
  if (curves) {
    session.curve = std::move(curves->main);
    session.twin = std::move(curves->twin);
  }
  TODBENCH_TRY(session.comparison, read_record(folder / "comparison.json", comparison_from));
  TODBENCH_TRY(session.measures, read_measures(folder));
  TODBENCH_TRY(session.uncertainty, read_record(folder / "uncertainty.json", uncertainty_from));
  TODBENCH_TRY(session.verdict, read_record(folder / "verdict.json", verdict_from));
  TODBENCH_TRY(session.cost, read_record(folder / "cost.json", cost_from));
  return session;
}

std::optional<std::string> ended_early(const Session& session) {
  const std::optional<RunRecord>& run = session.provenance.run;
  if (run && !run->ended_by.empty()) return run->ended_by;
  if (!session.complete()) return "the session was not finished";
  return std::nullopt;
}

Verdict verdict_of(const Session& session) {
  if (session.verdict) return *session.verdict;
  return judge(
      {.limits = session.plan.limits,
       .curve = session.curve.value_or(TodCurve{}),
       .comparison = session.comparison,
       .ended_early = ended_early(session),
       .judged = JudgedWhen::afterwards,
       .uncertainty = session.uncertainty ? &*session.uncertainty : nullptr,
       .air_transmittance =
           session.provenance.camera ? contrast_transmittance(session.plan, session.presentations) : std::nullopt,
       .measures = session.measures && session.measures->main ? std::optional(quantities_of(*session.measures->main))
                                                              : std::nullopt});
}

Result<void> keep_verdict(const std::filesystem::path& folder, const Verdict& verdict) {
  if (!is_there(folder / manifest_name)) return {};
  TODBENCH_TRY_VOID(write_json_file(folder / "verdict.json", verdict_record(verdict)));
  return refresh_manifest(folder, {"verdict.json"});
}

}  // namespace todbench
