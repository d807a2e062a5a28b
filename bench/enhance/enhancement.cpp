// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/enhancement.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <stop_token>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/devices/processed_source.h"
#include "bench/enhance/decidable.h"
#include "bench/enhance/package_spread.h"
#include "bench/enhance/stage_scan.h"
#include "bench/enhance/unseen_differences.h"
#include "bench/judgement/run_findings.h"
#include "bench/plan/plan_options.h"
#include "bench/run/recorded_bench.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/module_chain.h"
#include "bench/twin/simulated_responses.h"
#include "bench/twin/simulated_set_up.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "tod/adequacy/adequacy.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr std::size_t most_error_lines = 100;
/// Within the frames averaged for the registration, after slow filters have settled.
constexpr std::size_t picture_frame = 30;

int longest_memory(const std::vector<EnhancementPackage>& packages) {
  int longest = 0;
  for (const auto& package : packages) longest = std::max(longest, memory_frames({}, package));
  return longest;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void keep_line(PackageResult& result, std::string_view line) {
  if (result.error_lines.size() < most_error_lines) result.error_lines.emplace_back(line);
}

/// Plan and judges that all chains of a comparison share.
struct Chains {
  const LoadedPlan& loaded;
  const ExperimentInputs& inputs;
  const EnhancementOptions& options;
  Observer& observer;
  OpenEnds& ends;
  std::stop_token stop;
  [[nodiscard]] const Plan& plan() const { return loaded.plan(); }
};

/// Fits the curve of the trials, with what the measurement says about each point.
Result<TodCurve> curve_of(const Chains& chains, const PackageResult& result, const MeasurementResult* measured) {
  const Plan& plan = chains.plan();
  TODBENCH_TRY(TodCurve curve, tod_curve(result.trials, fit_options(plan)));
  curve.sensor = chains.inputs.sensor.name;
  curve.observer = observer_name(plan, chains.inputs);
  if (measured != nullptr) keep_noise(*measured, curve);
  for (TodPoint& point : curve.points) {
    // Successive frames differ by their places within a pixel, which is no memory of the noise.
    if (chains.options.dither > 1) point.lag1_correlation.reset();
    point.estimator_reason =
        plan.fit.estimator == EstimatorChoice::automatic ? EstimatorReason::package : EstimatorReason::plan;
    point.answers =
        AnswersTaken{AnswerKind::binary, 1,
                     plan.schedule.answers == AnswersChoice::automatic ? AnswersReason::package : AnswersReason::plan};
  }
  examine(curve, fit_options(plan));
  if (measured != nullptr) (void)add_run_findings(curve, plan, {.constancy = measured->constancy});
  return curve;
}

/// Runs one chain on a bench and stores the outcome, including its error, in `result`.
void run_one(const Chains& chains, SimulatedSetUp set_up, const std::vector<ModulePlan>& modules,
             const EnhancementPackage* package, PackageResult& result) {
  // Plate and contrast are located in the pictures of the camera itself, because a package may change the scale.
  const auto record = std::make_shared<ProcessingRecord>();
  const auto on_error_line = [&result](std::string_view line) { keep_line(result, line); };
  auto stages = module_stages(modules, on_error_line);
  if (package != nullptr) std::ranges::move(made_stages(*package, on_error_line), std::back_inserter(stages));
  result.samples_per_pixel = set_up.options.judged_samples_per_pixel = samples_per_pixel(stages);
  const auto camera =
      processed_source(std::move(set_up.bench.camera), std::move(stages), ProcessedAs::judged, picture_frame, record);
  MeasurementListener listener;
  listener.on_progress = chains.options.on_progress;
  listener.on_trial = [&, simulated = set_up.bench.simulated](Trial trial) {
    // A simulated exposure has no host time.
    if (simulated) trial.host_time_ns = trial.device_time_ns;
    trial.probability_correct.reset();
    trial.frames = 1;
    result.trials.push_back(std::move(trial));
  };
  listener.on_patch = [&](const Trial& trial, const Patch& patch) {
    chains.ends.judge(trial, patch, set_up.options, result.at_ends);
  };
  const auto measured = measure(*camera, *set_up.bench.target, chains.observer, *set_up.schedule, set_up.options,
                                *set_up.bench.host, listener, chains.stop);
  result.error = measured ? measured->ended_by : measured.error();
  if (measured) result.judged = measured->judged_contrasts;
  result.frame_ms = median_of(record->frame_ms);
  result.frames = record->frame_ms.size();
  result.clipped_pixels = record->clipped;
  result.picture = record->picture;
  if (result.trials.empty()) return;
  if (auto curve = curve_of(chains, result, measured ? &*measured : nullptr)) {
    result.curve = std::move(*curve);
  } else if (!result.error) {
    result.error = curve.error();
  }
}

/// The same with a new simulated sensor.
void run_simulated_one(const Chains& chains, const EnhancementPackage* package, int settle_frames,
                       PackageResult& result) {
  const auto on_error_line = [&result](std::string_view line) { keep_line(result, line); };
  const auto& modules = chains.inputs.sensor.modules;
  auto set_up = simulated_set_up(chains.plan(), chains.inputs, {}, chains.stop,
                                 {.on_error_line = on_error_line, .dither = chains.options.dither});
  if (!set_up) {
    result.error = set_up.error();
    return;
  }
  set_up->options.frames_after_change = settle_frames;
  set_up->options.answers = AnswerKind::binary;
  set_up->options.frames_per_presentation = 1;
  set_up->options.frames_at_contrast.clear();
  run_one(chains, *std::move(set_up), modules, package, result);
}

/// The same with the recorded bench of a session: the measurement has to ask the recorded questions.
void run_recorded_one(const Chains& chains, const std::filesystem::path& session, const EnhancementPackage* package,
                      PackageResult& result) {
  const Plan& plan = chains.plan();
  const ExperimentInputs& inputs = chains.inputs;
  if (plan.camera.contrast == ContrastUnit::grey_levels) {
    result.error = Error{ErrorCode::invalid_input,
                         "packages cannot process frames in grey levels, because the gain control "
                         "of the camera sets their contrast"};
    return;
  }
  auto recording = open_recorded_bench(session, nullptr);
  if (!recording) {
    result.error = recording.error();
    return;
  }
  MeasurementOptions measuring = measurement_options(plan, inputs.plates, plan.camera.ifov_mrad);
  take_answers(measuring, plan, inputs);  // the recorded number of frames; only answers to the first frame count
  const SensorModel model(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  auto response = simulated_responses(model, plan, inputs.plates, measuring, chains.stop);
  if (!response) {
    result.error = response.error();
    return;
  }
  measuring.contrast_response = *std::move(response);
  measuring.free_running = !recording->bench.simulated;
  auto schedule =
      make_schedule(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured, RandomStream(plan.seed, "schedule"));
  run_one(chains, {std::move(measuring), std::move(recording->bench), std::move(schedule)}, {}, package, result);
  if (auto agreed = recording->answers->agreed(); !agreed && !result.error) result.error = agreed.error();
}

/// Fits the trials at one contrast, without one group of presentations; empty without a threshold.
std::optional<PsychometricFit> fit_of(std::span<const Trial> trials, double set_delta_t_k,
                                      const std::function<bool(std::int64_t presentation)>& included,
                                      FitOptions options) {
  std::map<double, Level> levels;
  for (const Trial& trial : trials) {
    if (!same_contrast(trial.set_delta_t_k, set_delta_t_k) || !included(trial.presentation)) continue;
    Level& level = levels[trial.size_mrad];
    level.size = trial.size_mrad;
    level.total += 1;
    level.correct += trial.correct() ? 1 : 0;
  }
  std::vector<Level> list;
  for (const auto& [size, level] : levels) list.push_back(level);
  options.with_posterior = false;
  options.graded = false;
  const auto fit = fit_psychometric(list, options);
  if (!fit || !fit->threshold || !(*fit->threshold > 0)) return std::nullopt;
  return *fit;
}

/// Assigns the presentations at one contrast that both runs contain to groups in turn.
std::map<std::int64_t, std::size_t> groups_of(std::span<const Trial> with, std::span<const Trial> without,
                                              double set_delta_t_k) {
  constexpr std::size_t most_groups = 20;
  std::set<std::int64_t> a, common;
  for (const Trial& trial : with) {
    if (same_contrast(trial.set_delta_t_k, set_delta_t_k)) a.insert(trial.presentation);
  }
  for (const Trial& trial : without) {
    if (a.contains(trial.presentation)) common.insert(trial.presentation);
  }
  const std::size_t count = std::min(most_groups, common.size());
  std::map<std::int64_t, std::size_t> groups;
  std::size_t next = 0;
  for (const auto presentation : common) groups[presentation] = next++ % count;
  return groups;
}

PairedRatio ratio_at(std::span<const Trial> with, std::span<const Trial> without, double set_delta_t_k,
                     const FitOptions& options) {
  PairedRatio ratio{.set_delta_t_k = set_delta_t_k, .ratio = {}, .ci95 = {}};
  const auto groups = groups_of(with, without, set_delta_t_k);
  std::size_t count = 0;
  for (const auto& [presentation, group] : groups) count = std::max(count, group + 1);
  PsychometricFit fit_without;
  // ln of S75 without over S75 with the package; `left_out` beyond the last group leaves none out.
  const auto ln_ratio = [&](std::size_t left_out) -> std::optional<double> {
    const auto included = [&](std::int64_t presentation) {
      const auto found = groups.find(presentation);
      return found != groups.end() && found->second != left_out;
    };
    const auto a = fit_of(with, set_delta_t_k, included, options);
    const auto b = fit_of(without, set_delta_t_k, included, options);
    if (!a || !b) return std::nullopt;
    if (left_out == count) fit_without = *b;
    return std::log(*b->threshold) - std::log(*a->threshold);
  };
  const auto whole = ln_ratio(count);
  if (!whole) return ratio;
  ratio.ratio = std::exp(*whole);
  std::vector<double> values;
  for (std::size_t group = 0; group < count; ++group) {
    const auto value = ln_ratio(group);
    if (!value) return ratio;
    values.push_back(*value);
  }
  if (values.size() < 4) return ratio;
  const double n = static_cast<double>(values.size()), mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  double half = distribution::quantile(distribution::StudentsT(n - 1), 0.975) * std::sqrt((n - 1) / n * squares);
  if (const auto answers = paired_answers(with, without, set_delta_t_k);
      !answers.identical && answers.differing < enough_differing) {
    const auto unseen = unseen_ln_ratio(answers, without, set_delta_t_k, fit_without, options.form);
    if (!unseen) return ratio;
    half = std::max(half, *unseen);
  }
  ratio.ci95 = {std::exp(*whole - half), std::exp(*whole + half)};
  return ratio;
}

}  // namespace

Result<ExperimentInputs> full_inputs(const LoadedPlan& loaded) {
  const Plan& plan = loaded.plan();
  TODBENCH_TRY(auto accuracy, accuracy_of(plan));
  TODBENCH_TRY_VOID(check_sensor_module(loaded.sensor(), plan.simulation.motion));
  ExperimentInputs inputs;
  inputs.plates = loaded.plates();
  inputs.observer = loaded.observer();
  inputs.motion = plan.simulation.motion;
  inputs.stated_noise_counts = noise_in_counts(loaded.sensor());
  inputs.effects = full_plan(loaded.sensor(), plan.simulation.skip, plan.simulation.force, inputs.motion);
  inputs.sensor = as_planned(loaded.sensor(), inputs.effects);
  inputs.accuracy = accuracy;
  return inputs;
}

PackageResult simulate_package(const LoadedPlan& loaded, const EnhancementPackage* package, int settle_frames,
                               const EnhancementOptions& options, std::stop_token stop) {
  PackageResult result;
  result.name = package == nullptr ? "none" : package->name;
  const auto inputs = full_inputs(loaded);
  if (!inputs) {
    result.error = inputs.error();
    return result;
  }
  if (auto fits = check_simulated_geometry(loaded.plan(), *inputs); !fits) {
    result.error = fits.error();
    return result;
  }
  const auto observer = observer_of(loaded.plan(), *inputs, [&](std::string_view line) { keep_line(result, line); });
  // A program in place of the observer has no open parameters.
  OpenEnds ends(observer_module(loaded.plan()) == nullptr ? inputs->observer : TemplateObserverSpec{});
  run_simulated_one({loaded, *inputs, options, *observer, ends, std::move(stop)}, package, settle_frames, result);
  return result;
}

int memory_frames(const SensorSpec& sensor, const EnhancementPackage& package) {
  int sum = settle_frames(sensor.modules);
  const auto stages = made_stages(package, {});
  for (const auto& stage : stages) sum += stage->memory_frames();
  return sum;
}

Result<void> check_paired_plan(const Plan& plan) {
  if (plan.schedule.kind == ScheduleKind::adaptive)
    return fail(ErrorCode::invalid_input,
                "an adaptive schedule would show each package different frames: [schedule] kind must be 'constant'");
  if (plan.fit.estimator == EstimatorChoice::twin_shape || plan.schedule.answers == AnswersChoice::graded)
    return fail(
        ErrorCode::invalid_input,
        "the psychometric functions of the sensor do not include a package: [fit] estimator must be 'weibull' or "
        "'automatic', [schedule] answers must be 'binary'");
  return {};
}

std::vector<PairedRatio> paired_ratios(std::span<const Trial> with, std::span<const Trial> without,
                                       const FitOptions& options) {
  std::vector<double> contrasts;
  for (const Trial& trial : without) {
    const bool known = std::any_of(contrasts.begin(), contrasts.end(),
                                   [&](double contrast) { return same_contrast(contrast, trial.set_delta_t_k); });
    if (!known) contrasts.push_back(trial.set_delta_t_k);
  }
  std::sort(contrasts.begin(), contrasts.end(), std::greater<>());
  std::vector<PairedRatio> ratios;
  for (const double contrast : contrasts) ratios.push_back(ratio_at(with, without, contrast, options));
  return ratios;
}

namespace {

/// Runs without a package first, then every package, with the ratios to the first.
Result<Enhancement> through_all(
    const LoadedPlan& loaded, const ExperimentInputs& inputs, const std::vector<EnhancementPackage>& packages,
    const EnhancementOptions& options, const std::stop_token& stop,
    const std::function<void(const Chains& chains, const EnhancementPackage* package, PackageResult& result)>& run) {
  const bool noise_known = options.dither == 1;
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  OpenEnds ends(noise_known ? inputs.observer : TemplateObserverSpec{});
  const Chains chains{loaded, inputs, options, observer, ends, stop};
  const FitOptions fit = fit_options(loaded.plan());
  Enhancement enhancement;
  if (!noise_known && inputs.observer.eye)
    enhancement.warnings.emplace_back(
        "no spread over the open parameters of the observer: at an end of their range its noise is proportional to "
        "the sensor noise, which dithered frames do not show");
  for (std::size_t i = 0; i <= packages.size() && !stop.stop_requested(); ++i) {
    const EnhancementPackage* package = i == 0 ? nullptr : &packages[i - 1];
    PackageResult result;
    result.name = package == nullptr ? "none" : package->name;
    if (options.on_package) options.on_package(result.name);
    run(chains, package, result);
    if (package == nullptr && result.error) return tl::unexpected(*result.error);
    const PackageResult* none = package == nullptr ? nullptr : &enhancement.results.front();
    if (none != nullptr) result.ratios = paired_ratios(result.trials, none->trials, fit);
    std::ranges::move(add_spreads(fit, none, result), std::back_inserter(enhancement.warnings));
    if (none != nullptr) withhold_undecided(result.ratios, result, *none);
    if (auto note = why_not_linear(result); !note.empty()) enhancement.warnings.push_back(std::move(note));
    enhancement.results.push_back(std::move(result));
  }
  if (stop.stop_requested()) return fail(ErrorCode::interrupted, "interrupted");
  return enhancement;
}

}  // namespace

Result<Enhancement> compare_packages(const LoadedPlan& loaded, const std::vector<EnhancementPackage>& packages,
                                     const EnhancementOptions& options, std::stop_token stop) {
  const Plan& plan = loaded.plan();
  TODBENCH_TRY_VOID(check_paired_plan(plan));
  TODBENCH_TRY_VOID(refuse_modules(plan, loaded.sensor()));
  if (auto same = check_scans(packages, options.dither); !same) return tl::unexpected(same.error());
  // The noise of a pixel comes from successive frames, whose edges are at other places with dither.
  if (options.dither > 1 && loaded.observer().sensor_noise_factor != 1)
    return fail(ErrorCode::invalid_input,
                "an observer whose noise is proportional to the sensor noise cannot judge dithered frames");
  TODBENCH_TRY(const auto inputs, full_inputs(loaded));
  TODBENCH_TRY_VOID(check_simulated_geometry(plan, inputs));
  const int settle = longest_memory(packages);
  auto enhancement = through_all(loaded, inputs, packages, options, stop,
                                 [&](const Chains& chains, const auto* package, PackageResult& result) {
                                   run_simulated_one(chains, package, settle, result);
                                 });
  if (!enhancement) return enhancement;
  enhancement->settle_frames = settle;
  enhancement->dither = options.dither;
  enhancement->camera = loaded.sensor().name;
  enhancement->frame_rate_hz = loaded.sensor().frame_rate_hz;
  return enhancement;
}

Result<Enhancement> compare_packages_recorded(const std::filesystem::path& session, const LoadedPlan& loaded,
                                              const std::vector<EnhancementPackage>& packages,
                                              const EnhancementOptions& options, std::stop_token stop) {
  const Plan& plan = loaded.plan();
  TODBENCH_TRY_VOID(check_paired_plan(plan));
  TODBENCH_TRY_VOID(refuse_modules(plan, loaded.sensor()));
  EffectPlanner planner;
  TODBENCH_TRY(const auto inputs, experiment_inputs(loaded, planner));
  TODBENCH_TRY(const auto recording, open_recorded_bench(session, nullptr));
  const SourceInfo& info = recording.bench.camera->info();
  auto enhancement = through_all(loaded, inputs, packages, options, stop,
                                 [&](const Chains& chains, const auto* package, PackageResult& result) {
                                   run_recorded_one(chains, session, package, result);
                                 });
  if (!enhancement) return enhancement;
  enhancement->settle_frames = plan.measurement.frames_after_change;
  enhancement->dither = options.dither;
  enhancement->camera = info.model + " " + info.serial;
  enhancement->frame_rate_hz = info.frame_rate_hz;
  for (const auto& package : packages) {
    const int memory = memory_frames({}, package);
    if (memory <= plan.measurement.frames_after_change) continue;
    enhancement->warnings.push_back(
        fmt::format("{} has a memory of {} frames, but the recorded run discarded only {} after each change. Its first "
                    "frames still contain the previous scene",
                    package.name, memory, plan.measurement.frames_after_change));
  }
  return enhancement;
}

Result<LoadedPlan> recorded_plan(const std::filesystem::path& session, const Opening& opening) {
  TODBENCH_TRY(auto recorded,
               open_session(session, {.accept_changed = opening.accept_changed, .accept_cut_off = true}));
  Plan plan = recorded.plan;
  plan.measurement.record_frames = false;
  plan.measures = {};
  return LoadedPlan::of(std::move(plan), recorded.parts);
}

}  // namespace todbench
