// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/scene_dependence/scene_dependence_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/run/session_end.h"
#include "bench/session/ending_reserve.h"
#include "bench/session/json_output.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/twin/module_chain.h"

namespace todbench {
namespace {

constexpr const char* package_copy = "inputs/package.toml";

/// Smallest and largest distance of a ratio from 1 within its interval, in ln.
std::pair<double, double> distances(const Interval& ratio) {
  const double low = std::log(ratio.low.value_or(1)), high = std::log(ratio.high.value_or(1));
  const double near = low <= 0 && high >= 0 ? 0 : std::min(std::abs(low), std::abs(high));
  return {near, std::max(std::abs(low), std::abs(high))};
}

/// Returns the size that decides: by the near end of its interval if the verdict is depends, otherwise by the far end.
const SizeDependence* worst_of(const SceneDependence& found) {
  const auto less = [&](const SizeDependence& a, const SizeDependence& b) {
    const auto [a_near, a_far] = distances(a.ci95);
    const auto [b_near, b_far] = distances(b.ci95);
    return found.verdict == SceneDependenceVerdict::depends ? a_near < b_near : a_far < b_far;
  };
  const auto worst = std::max_element(found.sizes.begin(), found.sizes.end(), less);
  return worst == found.sizes.end() ? nullptr : &*worst;
}

/// Ratios and pictures as physical measures for report, table and history.
MeasureLines lines_of(const SceneDependence& found, const SceneDependenceTask& task) {
  MeasureLines out;
  for (const SizeDependence& size : found.sizes) {
    out.lines.push_back(measure_line(
        fmt::format("scene_ratio ({:g} mm)", size.size_mm), size.ratio, size.ci95,
        fmt::format("{} triangles of {:.2f} px at {:g} K, {} cycles of 4 x {} frames; simultaneous "
                    "intervals for all sizes",
                    size.triangles, size.size_px, found.set_delta_t_k, found.cycles, task.options.frames)));
  }
  double black = 0, white = 1;
  cv::minMaxLoc(found.out, &black, &white);
  for (const auto& [name, picture] : {std::pair("bar_out", &found.out), std::pair("bar_in", &found.in)})
    out.maps.push_back({name, picture->cols, picture->rows, 0, 0, grey_png(*picture, black, white)});
  out.reasons = found.notes;
  return out;
}

class BarSession {
 public:
  BarSession(const LoadedPlan& loaded, const SceneDependenceTask& task, const ExperimentOptions& options,
             const ExperimentListener& listener)
      : loaded_(loaded), task_(task), options_(options), listener_(listener) {}

  Result<SceneDependenceSession> operator()(std::stop_token stop) {
    SceneDependenceOptions measuring = task_.options;
    measuring.on_begin = [this](const SourceInfo& info, const Target& target) { return begin(info, target); };
    auto found = plan_scene_dependence(loaded_, task_.package ? &*task_.package : nullptr, task_.bar_k, measuring,
                                       options_.host, std::move(stop));
    if (!folder_) return tl::unexpected(found ? Error{ErrorCode::internal, "no session was started"} : found.error());
    const OpenSession open{*folder_, listener_};
    if (!found) return abandon(open, loaded_.plan(), provenance_, found.error());
    keep(*found);
    Verdict verdict = verdict_on(*found, loaded_.plan().limits);
    free_ending_room(folder_->path(), EndingRoom::results);
    std::optional<Error> refused;
    if (auto written = write(*found); !written) refused = written.error();
    if (refused) {
      verdict.ended_early = refused->message;
      verdict.decision = VerdictKind::inconclusive;
    }
    auto closed = close_session(open, provenance_, verdict, refused);
    if (!closed && !refused) refused = closed.error();
    return SceneDependenceSession{*std::move(found), folder_->path(), std::move(verdict), refused};
  }

 private:
  Result<void> begin(const SourceInfo& info, const Target& target) {
    const bool simulated = loaded_.plan().camera.id.empty();
    provenance_ = begin_provenance(loaded_.plan(), simulated ? Side::simulated : Side::measured);
    const SimulationPlan& simulation = loaded_.plan().simulation;
    if (simulated) provenance_.modules = module_records(loaded_.plan(), loaded_.sensor(), Side::simulated);
    provenance_.effects = full_plan(loaded_.sensor(), simulation.skip, simulation.force);
    if (!simulated) provenance_.camera = camera_record(info);
    provenance_.target = simulated ? fmt::format("simulated scene, hot bar of {:g} K", task_.bar_k)
                                   : target.capabilities().description + ", hot bar moved by the operator";
    TODBENCH_TRY(auto folder, begin_session(loaded_, options_, provenance_));
    folder_.emplace(std::move(folder));
    if (listener_.on_session) listener_.on_session(folder_->path());
    for (const auto& warning : info.warnings) note(*folder_, listener_, warning);
    phase(*folder_, listener_, "measuring with a hot bar outside the field of view and inside it");
    return {};
  }

  void keep(const SceneDependence& found) {
    MeasurementResult run;
    run.set_ups = {found.set_up};
    run.frames_used = found.frames_used;
    run.frames_rejected = found.frames_rejected;
    run.frames_lost = found.frames_lost;
    run.temporal_noise_k = found.temporal_noise_k;
    run.notes = found.notes;
    if (task_.package)
      run.notes.push_back("with the package '" + task_.package->name + "', SHA-256 " + task_.package->sha256);
    provenance_.run = run_record(run, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count());
    for (const std::string& sentence : found.notes) note(*folder_, listener_, sentence);
  }

  Result<void> write(const SceneDependence& found) {
    if (task_.package) {
      TODBENCH_TRY_VOID(make_folder(folder_->path() / "inputs"));
      TODBENCH_TRY_VOID(write_file_atomically(folder_->path() / package_copy, task_.package->text));
    }
    TODBENCH_TRY_VOID(
        write_file_atomically(folder_->path() / "scene-dependence.json", to_page(scene_dependence_json(found, task_))));
    return folder_->write_measures(measures_record(lines_of(found, task_)));
  }

  const LoadedPlan& loaded_;
  const SceneDependenceTask& task_;
  const ExperimentOptions& options_;
  const ExperimentListener& listener_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::optional<SessionFolder> folder_;
  Provenance provenance_;
};

}  // namespace

Json scene_dependence_json(const SceneDependence& found, const SceneDependenceTask& task) {
  Json sizes = Json::array();
  for (const SizeDependence& size : found.sizes) {
    sizes.push_back({{"size_mm", size.size_mm},
                     {"size_px", size.size_px},
                     {"triangles", size.triangles},
                     {"ratio", size.ratio},
                     {"ratio_ci95", json_interval(size.ci95)}});
  }
  return {{"camera", found.camera},
          {"package", found.package.empty() ? Json() : Json(found.package)},
          {"bar_k", task.bar_k},
          {"plate", found.plate},
          {"set_delta_t_k", found.set_delta_t_k},
          {"cycles", found.cycles},
          {"frames", task.options.frames},
          {"settle_frames", task.options.settle_frames},
          {"tolerance_percent", found.tolerance_percent},
          {"verdict", to_string(found.verdict)},
          {"sizes", sizes},
          {"notes", found.notes}};
}

Verdict verdict_on(const SceneDependence& found, const LimitsPlan& limits) {
  Demand demand{.kind = DemandKind::scene_dependence, .delta_t_k = found.set_delta_t_k};
  demand.limit = found.tolerance_percent;
  Verdict verdict{.rule_in_words = in_words(ConformityRule::guarded_acceptance_and_rejection)};
  demand.reason = "no interval lies completely beyond the tolerance, but not every interval lies within it";
  verdict.reason = "these data do not decide the demand";
  if (found.verdict == SceneDependenceVerdict::independent) {
    demand.decision = VerdictKind::pass;
    demand.reason = "the intervals of all sizes lie within the tolerance";
    verdict.reason = "every demand is met";
  } else if (found.verdict == SceneDependenceVerdict::depends) {
    demand.decision = VerdictKind::fail;
    demand.reason = "the interval of a size lies completely beyond the tolerance";
    verdict.reason = "the demand is not met";
  }
  if (const SizeDependence* worst = worst_of(found)) {
    const auto percent = [](double distance) { return 100 * std::expm1(distance); };
    const auto [near, far] = distances(worst->ci95);
    demand.result = percent(std::abs(std::log(worst->ratio)));
    demand.interval = {percent(near), percent(far)};
    demand.reason += fmt::format("; the values shown are for {:g} mm", worst->size_mm);
  }
  verdict.decision = demand.decision;
  if (!limits.acuity.empty() || limits.equivalence_margin_percent || !limits.measures.empty() || !limits.zones.empty())
    verdict.reason += "; the other limits of the plan do not apply here and were not judged";
  verdict.demands = {std::move(demand)};
  return verdict;
}

Result<SceneDependenceSession> measure_scene_dependence_session(const LoadedPlan& loaded,
                                                                const SceneDependenceTask& task,
                                                                const ExperimentOptions& options,
                                                                const ExperimentListener& listener,
                                                                std::stop_token stop) {
  return BarSession(loaded, task, options, listener)(std::move(stop));
}

}  // namespace todbench
