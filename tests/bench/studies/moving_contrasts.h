// SPDX-License-Identifier: GPL-3.0-or-later
// Runs in which the contrast has not settled, of a camera whose threshold is known without trials.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/core/forwarding_source.h"
#include "bench/devices/devices.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/camera_surrogate.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/own_contrasts.h"
#include "bench/twin/simulated_responses.h"
#include "bench/twin/twin_shapes.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/bench/studies/graded_runs.h"
#include "tod/plate/test_pattern.h"

namespace todbench::testing {

/// A black body of first order in front of the simulated scene. Every frame counts 20 ms, and the contrast of a
/// presentation is that at its middle.
class SlowBlackBody final : public Target {
 public:
  SlowBlackBody(std::unique_ptr<Target> scene, double time_constant_s, double presentation_s)
      : scene_(std::move(scene)), time_constant_s_(time_constant_s), presentation_s_(presentation_s) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return scene_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    constexpr double band = 0.1, rate_per_s = 0.06;
    const double near = std::min(band, rate_per_s * time_constant_s_) * std::abs(state.delta_t_k);
    if (state.wait == ContrastWait::settled) body_k_ = state.delta_t_k;
    if (state.wait == ContrastWait::held) body_k_ = state.delta_t_k;
    const double away_k = body_k_ - state.delta_t_k;
    if (state.wait == ContrastWait::within_band && std::abs(away_k) > near)
      body_k_ = state.delta_t_k + std::copysign(near, away_k);
    body_k_ = state.delta_t_k + (body_k_ - state.delta_t_k) * std::exp(-presentation_s_ / time_constant_s_);
    rate_k_per_s_ = (state.delta_t_k - body_k_) / time_constant_s_;
    state_ = state;
    TargetState shown = state;
    shown.delta_t_k = body_k_;
    return scene_->present(shown, stop);
  }

  [[nodiscard]] const TargetState& state() const { return state_; }
  /// Of the black body during the last presentation.
  [[nodiscard]] double rate_k_per_s() const { return rate_k_per_s_; }

 private:
  TargetState state_;
  double rate_k_per_s_ = 0;
  std::unique_ptr<Target> scene_;
  double time_constant_s_, presentation_s_, body_k_ = 0;
};

/// A camera that looks at a plate whose triangles below 4 px change later than the others by `lag_s`: their contrast is
/// that of the black body minus lag times rate.
class LaggingTriangles final : public ForwardingSource {
 public:
  LaggingTriangles(std::unique_ptr<FrameSource> camera, const SlowBlackBody& body, const SensorModel& model,
                   std::vector<TargetPlate> plates, double distance_m, double lag_s)
      : ForwardingSource(std::move(camera)), body_(body), model_(model), distance_m_(distance_m), lag_s_(lag_s) {
    const double most_mm = 4 * distance_m * model.spec().ifov_mrad();
    for (TargetPlate& plate : plates) {
      std::erase_if(plate.triangles, [&](const PlateTriangle& triangle) { return triangle.size_mm >= most_mm; });
      small_.emplace(plate.name, std::move(plate));
    }
  }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (!frame || body_.state().plate.empty()) return frame;
    const TargetState& state = body_.state();
    PlateScene scene{.plate = mounted(small_.at(state.plate), state.mounting), .delta_t_k = 1};
    scene.distance_m = distance_m_;
    scene.shift_mm = state.shift_mm;
    const cv::Mat1d late = -lag_s_ * body_.rate_k_per_s() / model_.spec().kelvin_per_count * *model_.unit_signal(scene);
    cv::Mat1d counts;
    frame->counts.convertTo(counts, CV_64F);
    counts += late;
    counts.convertTo(frame->counts, CV_16U);
    return frame;
  }

 private:
  const SlowBlackBody& body_;
  const SensorModel& model_;
  std::map<std::string, TargetPlate> small_;
  double distance_m_, lag_s_;
};

/// A sensor without a name is not valid, so that no surrogate could have its values.
inline SensorSpec plain_sensor() {
  SensorSpec spec;
  spec.name = "plain";
  return spec;
}

/// A camera in front of a slow black body, and its twin.
struct MovingContrasts {
  std::string name;
  SensorSpec camera = plain_sensor(), twin = plain_sensor();
  bool ramp = true;  ///< otherwise within a settling band
  double time_constant_s = 2.2;
  int phases = 6;
  std::vector<int> frames{4}, mountings_per_plate{0};
  double lag_s = 0, stated_lag_s = 0;                    ///< of the triangles below 4 px; that of the plan
  std::vector<double> judged_k{10, 3.5, 1.2, 0.5, 0.3};  ///< contrasts of the result; of a ramp, none of the plan
};

inline void PrintTo(const MovingContrasts& design, std::ostream* out) {
  *out << design.name;
}

inline Plan plan_of(const MovingContrasts& design, std::uint64_t seed) {
  Plan plan;
  plan.name = "contrasts that have not settled";
  plan.seed = seed;
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = design.camera.ifov_mrad();
  plan.target.phases = design.phases;
  plan.target.mountings_per_plate = design.mountings_per_plate;
  plan.schedule.frames_per_presentation = design.frames;
  if (design.ramp) {
    plan.schedule.kind = ScheduleKind::ramp;
    plan.schedule.ramp_k_per_s = 7.3;  // 10 s from 16.9 to 0.23 K
    plan.schedule.from_delta_t_k = 16.9;
    plan.schedule.to_delta_t_k = 0.23;
    plan.target.max_contrast_lag_s = design.stated_lag_s;
  } else {
    plan.target.contrast_settling_band_percent = 10;
    plan.target.delta_t_k = design.judged_k;
  }
  return plan;
}

/// ln S75 of a run at a contrast, and half of its interval. At a contrast of 0: the number of findings of the ramps.
struct MovingResult {
  double delta_t_k = 0, ln_s75 = 0, half = 0;
};

/// The functions of the twin of a design, which its runs share.
using Surfaces = std::map<std::string, std::optional<ContrastSurface>>;

inline std::vector<MovingResult> results_of(const TodCurve& curve, const MovingContrasts& design) {
  std::vector<MovingResult> out;
  const auto add = [&](double delta_t_k, double s75, const Interval& ci) {
    if (ci.low && ci.high) out.push_back({delta_t_k, std::log(s75), 0.5 * std::log(*ci.high / *ci.low)});
  };
  for (const double judged_k : design.judged_k) {
    if (!design.ramp) {
      const TodPoint* point = point_at(curve, judged_k);
      if (point != nullptr && point->fit.threshold) add(judged_k, *point->fit.threshold, point->fit.ci95);
      continue;
    }
    // Of the continuous curve, straight in ln dT between its neighbours, which are 11 % apart.
    for (std::size_t i = 1; i < curve.continuous.size(); ++i) {
      const ContinuousPoint &a = curve.continuous[i - 1], &b = curve.continuous[i];
      if (!(a.delta_t_k >= judged_k && b.delta_t_k < judged_k)) continue;
      const double w = std::log(judged_k / a.delta_t_k) / std::log(b.delta_t_k / a.delta_t_k);
      const auto between = [w](double x, double y) { return std::exp((1 - w) * std::log(x) + w * std::log(y)); };
      add(judged_k, between(a.s75_mrad, b.s75_mrad),
          {between(*a.ci95.low, *b.ci95.low), between(*a.ci95.high, *b.ci95.high)});
    }
  }
  return out;
}

/// One run of the program's own measurement, with the surrogate that it learns from the frames.
inline std::vector<MovingResult> moving_run(const MovingContrasts& design, std::uint64_t seed, Surfaces& surfaces,
                                            std::vector<AdequacyFinding>* findings = nullptr) {
  const Plan plan = plan_of(design, seed);
  PlanParts parts = LoadedPlan::load(plan).value().parts();
  parts.sensor = design.twin;
  const LoadedPlan loaded = LoadedPlan::of(plan, std::move(parts)).value();
  EffectPlanner planner;
  ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
  inputs.effects = full_plan(design.twin, {}, {});
  inputs.sensor = design.twin;
  const auto model = std::make_shared<const SensorModel>(design.camera, full_plan(design.camera, {}, {}),
                                                         inputs.accuracy, 100'000 + seed);
  OpenedBench bench = simulated_bench(model, loaded.shown_plates(), plan.target.distance_m, {});
  SlowBlackBody target(std::move(bench.target), design.time_constant_s, design.ramp ? ramp_step_s : 0.24);
  if (design.lag_s != 0)
    bench.camera = std::make_unique<LaggingTriangles>(std::move(bench.camera), target, *model, loaded.shown_plates(),
                                                      plan.target.distance_m, design.lag_s);
  MeasurementOptions options = camera_options(plan, inputs.plates);
  take_answers(options, plan, inputs);
  options.free_running = false;
  options.frames_after_change = 0;
  static const auto responses = simulated_responses(SensorModel(inputs.sensor, inputs.effects, inputs.accuracy, 1),
                                                    plan, inputs.plates, options, {})
                                    .value();
  CameraSurrogate surrogate(loaded, inputs, responses);
  options.contrast_response = surrogate.responses();
  options.learn_response = [&surrogate](const SetUpPicture& found) { return surrogate.learn(found); };
  const auto schedule =
      make_schedule(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured, RandomStream(seed, "schedule"));
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  auto run = measure(*bench.camera, target, observer, *schedule, options, *bench.host, {}, {});
  if (!run || run->ended_by) {
    ADD_FAILURE() << design.name << " " << seed << ": " << (run ? run->ended_by->message : run.error().message);
    return {};
  }
  // As in the program, the presentations of a simulated scene have no times of the host.
  for (Presentation& shown : run->presentations) shown.host_time_ns.reset();
  const auto lent = surrogate.lent();
  // The surrogate differs from run to run.
  auto& surface = surfaces[lent ? design.name + " " + std::to_string(seed) : design.name];
  if (!surface) surface = contrast_surface(plan, lent ? *lent : inputs, {}).value();
  const std::vector<Trial> trials = at_set_contrasts(run->trials, *surface, 1);
  TodCurve curve = tod_curve(trials, fit_options(plan)).value();
  if (design.ramp) {
    const auto taken = take_ramp(curve, *run, *surface, plan);
    if (!taken) {
      ADD_FAILURE() << taken.error().message;
      return {};
    }
    if (findings != nullptr) *findings = taken->findings;
    auto results = results_of(curve, design);
    results.push_back({.delta_t_k = 0, .ln_s75 = static_cast<double>(taken->findings.size())});
    return results;
  } else {
    const auto said = fit_twin_shapes(curve, trials, lent ? *lent : inputs, fit_options(plan),
                                      direct_options(curve, inputs, {}, seed, {}));
    for (const auto& note : said.notes) ADD_FAILURE() << note;
  }
  return results_of(curve, design);
}

/// ln S75 without trials, and its standard error from the scatter of independent parts.
struct MovingTruth {
  double ln_s75 = 0, se = 0;
};

inline MovingTruth truth_of(const SensorSpec& sensor, double delta_t_k, int parts) {
  Plan plan;
  EffectPlanner planner;
  const ExperimentInputs inputs = experiment_inputs(LoadedPlan::load(plan).value(), planner).value();
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  double sum = 0, squares = 0;
  for (int part = 0; part < parts; ++part) {
    const auto found =
        direct_estimate(sensor, full_plan(sensor, {}, {}), observer, {delta_t_k},
                        {.accuracy = Accuracy::reference(), .seed = 3'000'000 + static_cast<std::uint64_t>(part)});
    const double ln_s75 = std::log(found.value()[0].s75_pitch * sensor.ifov_mrad());
    sum += ln_s75;
    squares += ln_s75 * ln_s75;
  }
  const double mean = sum / parts;
  return {mean, std::sqrt(std::max(0.0, squares / parts - mean * mean) / (parts - 1))};
}

/// Figures of one contrast over the seeds of a study.
struct MovingSummary {
  double delta_t_k = 0, bias_percent = 0, se_percent = 0, sd_percent = 0, half_percent = 0;
  double truth_mrad = 0, truth_se_percent = 0;
  int findings = 0;  ///< runs with a finding of the ramps, the same at every contrast
  int covered = 0, runs = 0;
};

/// Runs of studies in a file, one contrast a row: design; seed; contrast; ln S75; half of its interval. A share has a
/// file of its own, and knows those of the others.
class MovingRecord {
 public:
  explicit MovingRecord(const std::filesystem::path& file, const StudyShare& share = {}) : file_(file) {
    if (share.step > 1) file_.replace_extension("." + std::to_string(share.first) + file.extension().string());
    for (const auto& entry : std::filesystem::directory_iterator(file.parent_path())) {
      if (entry.path().filename().string().starts_with(file.stem().string() + ".")) read(entry.path());
    }
  }

  /// The run of a seed, made and kept if the files have none.
  const std::vector<MovingResult>& run(const MovingContrasts& design, std::uint64_t seed, Surfaces& surfaces) {
    auto& rows = runs_[{design.name, seed}];
    if (!rows.empty()) return rows;
    rows = moving_run(design, seed, surfaces);
    std::ofstream out(file_, std::ios::app);
    out.precision(12);
    for (const MovingResult& row : rows)
      out << design.name << ";" << seed << ";" << row.delta_t_k << ";" << row.ln_s75 << ";" << row.half << "\n";
    return rows;
  }

 private:
  void read(const std::filesystem::path& file) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      const std::size_t end = line.find(';');
      std::istringstream numbers(line.substr(end + 1));
      std::uint64_t seed = 0;
      char mark = 0;
      MovingResult row;
      numbers >> seed >> mark >> row.delta_t_k >> mark >> row.ln_s75 >> mark >> row.half;
      if (numbers) runs_[{line.substr(0, end), seed}].push_back(row);
    }
  }

  std::filesystem::path file_;
  std::map<std::pair<std::string, std::uint64_t>, std::vector<MovingResult>> runs_;
};

/// `truth_at` returns the truth at a contrast in kelvin.
inline std::vector<MovingSummary> study_of(const MovingContrasts& design, std::uint64_t first_seed, int runs,
                                           MovingRecord& record,
                                           const std::function<MovingTruth(double delta_t_k)>& truth_at) {
  Surfaces surfaces;
  std::map<double, std::vector<MovingResult>> by_contrast;
  int findings = 0;
  for (int i = 0; i < runs; ++i)
    for (const MovingResult& one : record.run(design, first_seed + static_cast<std::uint64_t>(i), surfaces)) {
      if (one.delta_t_k == 0)
        findings += one.ln_s75 > 0 ? 1 : 0;
      else
        by_contrast[one.delta_t_k].push_back(one);
    }
  std::vector<MovingSummary> out;
  for (const auto& [delta_t_k, results] : by_contrast) {
    const MovingTruth truth = truth_at(delta_t_k);
    const auto n = static_cast<double>(results.size());
    MovingSummary sum{.delta_t_k = delta_t_k,
                      .truth_mrad = std::exp(truth.ln_s75),
                      .truth_se_percent = 100 * truth.se,
                      .findings = findings,
                      .runs = static_cast<int>(results.size())};
    double squares = 0;
    for (const MovingResult& one : results) {
      const double error = 100 * (one.ln_s75 - truth.ln_s75);
      sum.bias_percent += error / n;
      squares += error * error;
      sum.half_percent += 100 * one.half / n;
      sum.covered += std::abs(error) <= 100 * one.half ? 1 : 0;
    }
    sum.sd_percent =
        std::sqrt(std::max(0.0, (squares - n * sum.bias_percent * sum.bias_percent) / std::max(1.0, n - 1)));
    sum.se_percent = sum.sd_percent / std::sqrt(n);
    out.push_back(sum);
  }
  return out;
}

inline std::vector<MovingContrasts> moving_designs() {
  SensorSpec blurred = plain_sensor(), noisy = blurred, columns = blurred, stopped = blurred, patterned = blurred;
  blurred.aberration_sigma_pitch = 0.35;
  noisy.netd_k *= 2;
  columns.column_noise_k = 0.035;
  stopped.f_number *= 2;
  patterned.fixed_pattern_k = 0.05;
  MovingContrasts band{.name = "band, equal", .ramp = false};
  band.judged_k = {16.9, 1.93, 0.23};
  MovingContrasts band_blur = band, band_noise = band;
  band_blur.name = "band, blur", band_blur.camera = blurred;
  // The design of least bench time for 2.5 % on the default bench (design_search.h).
  MovingContrasts band_best = band;
  band_best.name = "band, least time for 2.5 %", band_best.phases = 14;
  band_best.frames = {1, 1, 6}, band_best.mountings_per_plate = {3, 2};
  band_noise.name = "band, noise x 2", band_noise.camera = noisy;
  return {band,
          {.name = "ramp, equal"},
          {.name = "ramp, equal, black body of 8 s", .time_constant_s = 8},
          {.name = "ramp, blur", .camera = blurred},
          {.name = "ramp, noise x 2", .camera = noisy},
          {.name = "ramp, column noise", .camera = columns},
          {.name = "ramp, f-number x 2", .camera = stopped},
          {.name = "ramp, fixed pattern 0.05 K", .camera = patterned},
          band_blur,
          band_noise,
          band_best};
}

}  // namespace todbench::testing
