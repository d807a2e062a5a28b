// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/moving_target/dynamic_session.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/judgement/run_findings.h"
#include "bench/moving_target/dynamic_json.h"
#include "bench/plan/plan_options.h"
#include "bench/run/session_end.h"
#include "bench/session/csv_fields.h"
#include "bench/text/csv_table.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "bench/twin/module_chain.h"
#include "tod/adequacy/adequacy.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

bool of_the_curve(const MovingAnswer& answer) {
  return answer.speed_mrad_s == 0 && answer.observer == SequenceObserver::single_frame;
}

constexpr std::array<std::string_view, 12> moving_columns{"pair",      "speed_mrad_s", "observer",      "plate",
                                                          "mounting",  "triangle",     "set_delta_t_k", "delta_t_k",
                                                          "size_mrad", "truth",        "answer",        "frame"};

/// One answer as a row of moving-trials.csv; places and times are in the passes of dynamic.json.
std::string moving_row(const MovingAnswer& answer) {
  const Trial& t = answer.trial;
  return std::to_string(t.presentation) + "," + number_text(answer.speed_mrad_s) + "," +
         std::string(to_string(answer.observer)) + "," + csv_field(t.plate) + "," + std::string(to_string(t.mounting)) +
         "," + csv_field(t.triangle) + "," + number_text(t.set_delta_t_k) + "," + number_text(t.delta_t_k) + "," +
         number_text(t.size_mrad) + "," + std::string(to_string(t.truth)) + "," + std::string(to_string(t.answer)) +
         "," + std::to_string(t.frame) + "\n";
}

std::vector<Trial> trials_of_the_curve(const MovingMeasurement& measured) {
  std::vector<Trial> trials;
  for (const MovingAnswer& answer : measured.answers) {
    if (of_the_curve(answer)) trials.push_back(answer.trial);
  }
  return trials;
}

/// Files that grow during the run: after any end, the earlier answers are on the disk.
class GrowingFiles {
 public:
  [[nodiscard]] static Result<GrowingFiles> open(SessionFolder& folder, bool simulated) {
    auto trials = folder.open_trials(SessionCurve::main);
    if (!trials) return tl::unexpected(trials.error());
    TODBENCH_TRY(auto targets, folder.open_targets(SessionCurve::main));
    TODBENCH_TRY(auto moving, AppendFile::open(folder.path() / "moving-trials.csv", AppendFile::Start::empty));
    TODBENCH_TRY_VOID(moving.append(header_line(moving_columns)));
    return GrowingFiles{*std::move(trials), std::move(targets), std::move(moving), simulated};
  }

  [[nodiscard]] Result<void> append(const MovingAnswer& answer) {
    TODBENCH_TRY_VOID(moving_.append(moving_row(answer)));
    return of_the_curve(answer) ? trials_.append(answer.trial) : Result<void>();
  }
  [[nodiscard]] Result<void> append(Presentation shown) {
    if (simulated_) shown.host_time_ns.reset();
    return targets_.append(shown);
  }
  [[nodiscard]] Result<void> sync() {
    for (auto done : {moving_.sync(), trials_.sync(), targets_.sync()}) {
      if (!done) return done;
    }
    return {};
  }

 private:
  GrowingFiles(TrialsWriter trials, TargetsWriter targets, AppendFile moving, bool simulated)
      : trials_(std::move(trials)), targets_(std::move(targets)), moving_(std::move(moving)), simulated_(simulated) {}
  TrialsWriter trials_;
  TargetsWriter targets_;
  AppendFile moving_;
  bool simulated_;
};

std::string in_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "unknown";
}
std::string in_text(const Interval& interval) {
  return in_text(interval.low) + " to " + in_text(interval.high);
}

/// S75 at rest over the open parameters of the observer, for the points of the curve.
void add_spreads(const DynamicMeasurement& found, TodCurve& curve) {
  for (TodPoint& point : curve.points) {
    for (const DynamicContrast& contrast : found.contrasts) {
      if (contrast.set_delta_t_k == point.set_delta_t_k)
        point.s75_spread_mrad = contrast.speeds.front().points.front().s75_spread_mrad;
    }
  }
}

/// Notes about the motion, for the report.
std::vector<std::string> sentences(const DynamicMeasurement& found) {
  std::vector<std::string> out{
      "curve and verdict are for the plate at rest and single frames. These are the results for the moving plate"};
  for (const DynamicContrast& contrast : found.contrasts) {
    for (const DynamicAcuity& at : contrast.speeds) {
      for (const DynamicPoint& point : at.points) {
        if (at.speed_mrad_s == 0 && point.observer == SequenceObserver::single_frame) continue;
        const std::string ratio = at.speed_mrad_s == 0 ? "" : ", " + in_text(point.ratio) + " of the acuity at rest";
        out.push_back(fmt::format("{:+.3f} K at {:g} mrad/s ({:.2g} pixels per open), {}: acuity {} 1/mrad, 95 % {}{}",
                                  contrast.set_delta_t_k, at.speed_mrad_s, at.speed_px, to_string(point.observer),
                                  in_text(stated_acuity_per_mrad(point.fit)), in_text(acuity_interval(point.fit.ci95)),
                                  ratio));
        if (const auto acuity = acuity_spread_per_mrad(point.s75_spread_mrad))
          out.back() += "; " + in_text(*acuity) + " over the open parameters of the observer (no confidence interval)";
      }
    }
  }
  if (const auto& tau = found.time_constant)
    out.push_back(fmt::format("time constant {:.2f} ms, 95 % {}, from {} passes in both directions",
                              tau->time_constant_ms, in_text(tau->ci95_ms), tau->passes));
  return out;
}

/// Writes a running measurement to a folder.
class DynamicRun {
 public:
  DynamicRun(const LoadedPlan& loaded, const ExperimentOptions& options, const ExperimentListener& listener)
      : loaded_(loaded), options_(options), listener_(listener) {}

  Result<DynamicSession> operator()(const std::function<void(const MovingPassRecord&)>& on_pass, std::stop_token stop) {
    const Plan& plan = loaded_.plan();
    auto found =
        measure_dynamic(loaded_,
                        {.moving = {.on_presentation = [this](const Presentation& p) { return files_->append(p); },
                                    .on_answer = [this](const MovingAnswer& a) { return files_->append(a); },
                                    .on_pass = on_pass},
                         .on_open = [this](const OpenedBench& bench) { return begin(bench); },
                         .on_measured = [this](const MovingMeasurement& m) { return keep(m); }},
                        std::move(stop));
    if (!found && !folder_) return tl::unexpected(found.error());
    const OpenSession open{*folder_, listener_};
    if (!found) return abandon(open, plan, provenance_, found.error());
    const std::vector<Trial> trials = trials_of_the_curve(found->measured);
    auto curve = tod_curve(trials, fit_options(plan));
    if (!curve) return abandon(open, plan, provenance_, curve.error());
    curve->sensor = sensor_;
    curve->observer = loaded_.observer().name;
    for (TodPoint& point : curve->points) {
      point.estimator_reason =
          plan.fit.estimator == EstimatorChoice::automatic ? EstimatorReason::moving_target : EstimatorReason::plan;
      point.answers = AnswersTaken{
          AnswerKind::binary, 1,
          plan.schedule.answers == AnswersChoice::automatic ? AnswersReason::moving_target : AnswersReason::plan};
    }
    add_spreads(*found, *curve);
    examine(*curve, fit_options(plan));
    std::vector<std::string> said = sentences(*found);
    if (!plan.camera.id.empty()) {
      const MovingMeasurement& run = found->measured;
      for (auto& sentence :
           add_run_findings(*curve, plan, {.presentations = run.presentations, .constancy = run.constancy}))
        said.push_back(std::move(sentence));
    }
    for (const std::string& sentence : said) {
      note(*folder_, listener_, sentence);
      provenance_.run->notes.push_back(sentence);
    }
    const auto written =
        write_file_atomically(folder_->path() / "dynamic.json", to_page(dynamic_measurement_json(*found, plan)));
    ExperimentOutcome outcome{.folder = folder_->path(),
                              .curve = *std::move(curve),
                              .twin = std::nullopt,
                              .comparison = std::nullopt,
                              .verdict = {},
                              .effects = provenance_.effects,
                              .figures = figures_of(*provenance_.run),
                              .ended_by = written ? std::nullopt : std::optional(written.error())};
    outcome.presentations = found->measured.presentations;
    auto ended = concluded(std::move(outcome), plan, open, provenance_);
    return DynamicSession{*std::move(found), std::move(ended)};
  }

 private:
  Result<void> begin(const OpenedBench& bench) {
    const Plan& plan = loaded_.plan();
    const SourceInfo& info = bench.camera->info();
    sensor_ = plan.camera.id.empty() ? loaded_.sensor().name : info.model + " " + info.serial;
    provenance_ = begin_provenance(plan, plan.camera.id.empty() ? Side::simulated : Side::measured);
    provenance_.effects = full_plan(loaded_.sensor(), plan.simulation.skip, plan.simulation.force, any_motion);
    if (!plan.camera.id.empty()) provenance_.camera = camera_record(info);
    provenance_.target = plan.camera.id.empty() ? "simulated scene" : bench.target->capabilities().description;
    TODBENCH_TRY(auto folder, begin_session(loaded_, options_, provenance_));
    folder_.emplace(std::move(folder));
    TODBENCH_TRY(auto files, GrowingFiles::open(*folder_, bench.simulated));
    files_.emplace(std::move(files));
    if (listener_.on_session) listener_.on_session(folder_->path());
    for (const auto& warning : bench.camera->info().warnings) note(*folder_, listener_, warning);
    phase(*folder_, listener_, "measuring with a moving target");
    return {};
  }

  Result<void> keep(const MovingMeasurement& measured) {
    MeasurementResult result;
    result.set_ups = measured.set_ups;
    result.frames_used = measured.frames_used;
    result.frames_rejected = measured.frames_rejected;
    result.frames_lost = measured.frames_lost;
    result.temporal_noise_k = measured.temporal_noise_k;
    result.notes = measured.notes;
    result.ended_by = measured.ended_by;
    provenance_.run =
        run_record(result, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count());
    for (const std::string& sentence : measured.notes) note(*folder_, listener_, sentence);
    return files_->sync();
  }

  const LoadedPlan& loaded_;
  const ExperimentOptions& options_;
  const ExperimentListener& listener_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::optional<SessionFolder> folder_;
  std::optional<GrowingFiles> files_;
  Provenance provenance_;
  std::string sensor_;  ///< sensor of the curve
};

}  // namespace

Result<void> check_dynamic_plan(const Plan& plan, const SensorSpec& sensor) {
  const std::pair<bool, const char*> refused[] = {
      {has_modules(plan, sensor), "[[module]]"},
      {plan.camera.contrast == ContrastUnit::grey_levels, "contrasts in grey levels ([camera] contrast)"},
      {plan.camera.nuc_interval_s > 0, "corrections on command ([camera] nuc_interval_s)"},
      {plan.schedule.kind == ScheduleKind::adaptive, "an adaptive schedule ([schedule] kind)"},
      {plan.schedule.answers == AnswersChoice::graded, "graded answers ([schedule] answers)"},
      {plan.fit.estimator == EstimatorChoice::twin_shape, "the function of the twin ([fit] estimator)"},
      {plan.measurement.record_frames, "recorded frames ([measurement] record_frames)"},
      {plan.measures.any(), "physical measures ([measures])"},
      {plan.limits.equivalence_margin_percent.has_value(),
       "agreement with a twin ([limits] equivalence_margin_percent)"}};
  std::string names;
  for (const auto& [asked, name] : refused) {
    if (asked) names += (names.empty() ? "" : ", ") + std::string(name);
  }
  if (names.empty()) return {};
  return fail(ErrorCode::invalid_input, "a moving target cannot be measured with " + names);
}

Result<DynamicSession> measure_dynamic_session(const LoadedPlan& loaded, const ExperimentOptions& options,
                                               const ExperimentListener& listener,
                                               const std::function<void(const MovingPassRecord&)>& on_pass,
                                               std::stop_token stop) {
  TODBENCH_TRY_VOID(check_dynamic_plan(loaded.plan(), loaded.sensor()));
  return DynamicRun(loaded, options, listener)(on_pass, std::move(stop));
}

}  // namespace todbench
