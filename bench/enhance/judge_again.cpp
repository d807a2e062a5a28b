// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/judge_again.h"

#include <fmt/format.h>

#include <utility>

#include "acquisition/base/try.h"
#include "bench/enhance/enhancement.h"
#include "bench/enhance/stage_scan.h"
#include "bench/session/signature.h"
#include "bench/text/files.h"
#include "bench/twin/module_chain.h"

namespace todbench {
namespace {

/// Returns the digest of the key of a valid signature; empty if the session is not signed.
Result<std::string> verified_signer(const std::filesystem::path& session) {
  TODBENCH_TRY(const auto signature, check_signature(session, std::nullopt));
  if (!signature) return std::string();
  if (signature->valid) return signature->signature.key_sha256();
  return fail(ErrorCode::invalid_input,
              session.string() + ": the signature of the session is not valid: " + signature->sentence);
}

/// Returns the plan of the new session.
Result<Plan> plan_for(Plan plan, const JudgeRequest& request) {
  if (request.display) plan.display = *request.display;
  if (!request.observer.empty()) {
    std::erase_if(plan.modules, [](const ModulePlan& module) { return module.place == ModulePlace::observer; });
    plan.observer = request.observer;
  }
  if (!request.package) return plan;
  if (plan.camera.contrast == ContrastUnit::grey_levels) {
    return fail(ErrorCode::invalid_input,
                "packages cannot process frames in grey levels, because the gain control of the camera sets their "
                "contrast");
  }
  plan.fit.estimator = EstimatorChoice::weibull;
  plan.schedule.answers = AnswersChoice::binary;
  plan.schedule.frames_per_presentation = SchedulePlan{}.frames_per_presentation;
  plan.simulation.paired = false;
  return plan;
}

/// Sets the stages of the package, and returns the notes that they call for.
std::vector<std::string> add_package(const EnhancementPackage& package, const LoadedPlan& recorded,
                                     const ExperimentInputs& inputs, ExperimentHost& host) {
  const Plan& plan = recorded.plan();
  host.added.make = [package](const auto& on_error_line) { return made_stages(package, on_error_line); };
  if (const auto factors = scan_factors(package); !factors.empty()) host.added.dither = factors.front();
  host.added.memory_frames = memory_frames({}, package);
  host.added.as_recorded = [plan, inputs](MeasurementOptions& camera) { take_answers(camera, plan, inputs); };
  std::vector<std::string> notes{"frames pass through package " + package.name +
                                 ": the answers are right or wrong and fitted with a Weibull function, because the "
                                 "functions of the sensor do not include the package"};
  if (host.added.memory_frames > plan.measurement.frames_after_change) {
    notes.push_back(
        fmt::format("{} has a memory of {} frames, but the recorded run discarded only {} after each change. Its first "
                    "frames still contain the previous scene",
                    package.name, host.added.memory_frames, plan.measurement.frames_after_change));
  }
  return notes;
}

}  // namespace

Result<ExperimentOutcome> judge_again(const std::filesystem::path& session, const JudgeRequest& request,
                                      ExperimentOptions options, const ExperimentListener& listener,
                                      std::stop_token stop, const Opening& opening, RunModules modules) {
  TODBENCH_TRY(RecordedRun run, open_recorded_run(session, options.host.pause, opening, modules));
  TODBENCH_TRY(std::string signer, verified_signer(session));
  const bool other = !request.observer.empty() || request.package;
  if (other && run.plan.schedule.kind == ScheduleKind::adaptive) {
    return fail(ErrorCode::invalid_input,
                session.string() +
                    ": the schedule of the session is adaptive, so its frames follow from the answers of its own "
                    "observer. Another observer needs a session with [schedule] kind = 'constant'");
  }
  TODBENCH_TRY(const LoadedPlan then, LoadedPlan::of(run.plan, run.session.parts));
  TODBENCH_TRY(Plan plan, plan_for(run.plan, request));
  TODBENCH_TRY(const LoadedPlan now, then.with(std::move(plan)));
  EffectPlanner planner;
  TODBENCH_TRY(ExperimentInputs inputs, request.package ? full_inputs(now) : experiment_inputs(now, planner));
  inputs.warnings.insert(inputs.warnings.end(), run.warnings.begin(), run.warnings.end());
  OriginRecord origin{.session = std::filesystem::absolute(session).lexically_normal().string(),
                      .manifest_sha256 = run.session.manifest_sha256,
                      .signed_by = std::move(signer),
                      .then = judged_by(then),
                      .now = judged_by(now)};
  if (observer_module(run.plan) != nullptr) origin.then.observer = "module";
  if (request.package) {
    origin.now.package = request.package->name;
    origin.now.package_sha256 = request.package->sha256;
    for (std::string& note : add_package(*request.package, then, inputs, options.host))
      inputs.warnings.push_back(std::move(note));
  }
  options.origin = std::move(origin);
  auto outcome = measure_on_bench(now, inputs, std::move(run.recording.bench), options, listener, std::move(stop));
  TODBENCH_TRY_VOID(run.recording.answers->agreed());
  return outcome;
}

}  // namespace todbench
