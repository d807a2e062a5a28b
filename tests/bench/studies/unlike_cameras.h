// SPDX-License-Identifier: GPL-3.0-or-later
// Whole sessions of cameras that are not as their twins are stated: what became of the threshold and of the ratio.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/forecast/prediction.h"
#include "bench/run/experiment.h"
#include "tests/bench/studies/graded_runs.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {

/// Contrasts of the study: the one that the optics are learnt from, and one at which noise decides.
inline const std::vector<double> unlike_contrasts_k{16.9, 0.5};

/// A camera, and the twin that the plan states. The microscan of a design is that of the camera.
inline std::vector<GradedDesign> unlike_designs() {
  const auto sensor = [](auto change) {
    SensorSpec spec;
    spec.name = "unlike";
    change(spec);
    return spec;
  };
  const auto row = [](const std::string& name, const SensorSpec& camera, const SensorSpec& twin, int phases = 12) {
    return GradedDesign{
        .name = name, .camera = camera, .twin = twin, .phases = phases, .delta_t_k = unlike_contrasts_k};
  };
  const auto midwave = [&](double blur_pitch) {
    return sensor([&](SensorSpec& s) {
      s.pitch_um = 15, s.detector_um = 13.5, s.focal_length_mm = 15 / (47.5 / 36.3);
      s.f_number = 4, s.wavelength_min_um = 3, s.wavelength_max_um = 5, s.netd_k = 0.03;
      s.aberration_sigma_pitch = blur_pitch;
    });
  };
  const SensorSpec plain = sensor([](SensorSpec& /*spec*/) {});
  const SensorSpec blurred = sensor([](SensorSpec& s) { s.aberration_sigma_pitch = 0.35; });
  const SensorSpec more = sensor([](SensorSpec& s) { s.aberration_sigma_pitch = 0.5; });
  const SensorSpec slow = sensor([](SensorSpec& s) { s.f_number = 2; });
  const SensorSpec columns = sensor([](SensorSpec& s) { s.column_noise_k = 0.07; });
  const SensorSpec remembers = sensor([](SensorSpec& s) { s.noise_correlation = 0.6; });
  const SensorSpec noisy = sensor([](SensorSpec& s) { s.netd_k = 0.14; });
  const SensorSpec defective = sensor([](SensorSpec& s) { s.defective_pixel_share = 0.001; });
  GradedDesign microscan = row("microscan", plain, plain, 3), microscan_12 = row("microscan, 12 phases", plain, plain);
  microscan.microscan = microscan_12.microscan = 2;
  GradedDesign adaptive = row("equal, adaptive, 3 %", plain, plain, 6),
               adaptive_noisy = row("NETD x 2, adaptive, 4 %", noisy, plain, 6);
  for (GradedDesign* one : {&adaptive, &adaptive_noisy}) one->delta_t_k = {16.9, 0.23};
  adaptive.adaptive_percent = 3, adaptive_noisy.adaptive_percent = 4;
  return {row("equal", plain, plain),
          adaptive,
          adaptive_noisy,
          row("blur 0.5 / 0.35", more, blurred),
          row("f/2 / f/1", slow, plain),
          row("column noise 70 mK / none", columns, plain),
          row("column noise 70 mK / 70 mK", columns, columns),
          row("noise correlation 0.6 / 0", remembers, plain),
          row("NETD x 2", noisy, plain),
          microscan,
          microscan_12,
          row("0.1 % of the detectors defective / none", defective, plain),
          row("blur 0.5 / 0.35, 3 phases", more, blurred, 3),
          row("f/2 / f/1, 3 phases", slow, plain, 3),
          row("column noise 70 mK / none, 3 phases", columns, plain, 3),
          row("NETD x 2, 3 phases", noisy, plain, 3),
          row("noise correlation 0.6 / 0, 3 phases", remembers, plain, 3),
          row("halo 3 % / none", sensor([](SensorSpec& s) { s.halo_share = 0.03, s.halo_sigma_pitch = 8; }), plain),
          row("detector 30 / 42.5 um", sensor([](SensorSpec& s) { s.detector_um = 30; }), plain),
          row("row noise 50 mK / none", sensor([](SensorSpec& s) { s.row_noise_k = 0.05; }), plain),
          row("fixed pattern 0.1 K / none", sensor([](SensorSpec& s) { s.fixed_pattern_k = 0.1; }), plain),
          row("NETD / 2", sensor([](SensorSpec& s) { s.netd_k = 0.035; }), plain),
          row("display blur 0.6 samples / none", sensor([](SensorSpec& s) { s.display_blur_samples = 0.6; }), plain),
          row("1 % of the detectors dead / none", sensor([](SensorSpec& s) { s.dead_pixel_share = 0.01; }), plain),
          row("time constant 12 ms / none", sensor([](SensorSpec& s) { s.time_constant_ms = 12; }), plain),
          row("two frames averaged / none", sensor([](SensorSpec& s) { s.frames_averaged = 2; }), plain),
          row("MWIR f/4 15 um, blur 0.6 / 0", midwave(0.6), midwave(0)),
          row("distortion 2 % / none", sensor([](SensorSpec& s) { s.distortion_percent = 2; }), plain),
          row("detector 42.5 x 25 um / 42.5 um", sensor([](SensorSpec& s) { s.detector_y_um = 25; }), plain),
          row("f/1.5, blur 0.25, NETD x 1.5, rows 40 mK / none", sensor([](SensorSpec& s) {
                s.f_number = 1.5, s.aberration_sigma_pitch = 0.25, s.netd_k = 0.105, s.row_noise_k = 0.04;
              }),
              plain),
          row("display bilinear / sample and hold",
              sensor([](SensorSpec& s) { s.display = DisplayReconstruction::bilinear; }), plain)};
}

inline SensorSpec camera_of(const GradedDesign& design) {
  SensorSpec camera = design.camera;
  camera.microscan = design.microscan;
  return camera;
}

/// One session by the program's own measurement. Rows "fit" and "paired".
inline std::vector<GradedResult> unlike_results(const GradedDesign& design, std::uint64_t seed) {
  const SensorSpec camera = camera_of(design);
  GradedDesign stated = design;
  stated.microscan = 1;
  Plan plan = plan_of(stated, seed);
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = camera.ifov_mrad() / camera.samples_per_pitch();
  plan.target.kind = TargetKind::scene;
  plan.target.phases = design.phases;
  plan.simulation.phases = 2;  // trials of the twin decide nothing here
  plan.simulation.accuracy = "normal";
  if (design.adaptive_percent > 0) {
    plan.schedule.kind = ScheduleKind::adaptive;
    plan.schedule.half_width_percent = design.adaptive_percent;
  }
  PlanParts parts = LoadedPlan::load(plan).value().parts();
  parts.sensor = design.twin;
  const LoadedPlan loaded = LoadedPlan::of(plan, std::move(parts)).value();
  const ExperimentInputs inputs = inputs_of(plan, design.twin);
  const auto model =
      std::make_shared<const SensorModel>(camera, full_plan(camera, {}, {}), inputs.accuracy, 100'000 + seed);
  const TemporaryFolder folder;
  ExperimentOptions options;
  options.folder = folder.path() / "session";
  const auto outcome = measure_on_bench(
      loaded, inputs, simulated_bench(model, loaded.shown_plates(), plan.target.distance_m, {}), options, {}, {});
  std::vector<GradedResult> results;
  if (!outcome || outcome->ended_by) {
    ADD_FAILURE() << design.name << " " << seed << ": "
                  << (outcome ? outcome->ended_by->message : outcome.error().message);
    return results;
  }
  add_results(results, design, seed, "fit", outcome->curve);
  if (!outcome->comparison) return results;
  for (const ComparisonPoint& point : outcome->comparison->points) {
    if (!point.paired) continue;
    results.push_back({design.name, seed, point.set_delta_t_k, "paired", point.paired->ratio, *point.paired->ci95.low,
                       *point.paired->ci95.high, 100 * point.paired->se_ln_ratio, point.paired->degrees_of_freedom + 1,
                       point.paired->twin_share});
  }
  return results;
}

/// ln S75 of a sensor at a contrast without trials, and its standard error.
struct DirectTruth {
  double s75_mrad = 0, se_percent = 0;
};

inline DirectTruth truth_of(const SensorSpec& sensor, double delta_t_k, int parts) {
  const GradedDesign design{.name = "truth"};
  const ExperimentInputs inputs = inputs_of(plan_of(design, 1), sensor);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  Accuracy accuracy = Accuracy::reference();
  accuracy.noise_draws = Accuracy::max_noise_draws;
  double sum = 0, squares = 0;
  for (int part = 0; part < parts; ++part) {
    const auto found = direct_estimate(sensor, full_plan(sensor, {}, {}), observer, {delta_t_k},
                                       {.accuracy = accuracy, .seed = 2'000'000 + static_cast<std::uint64_t>(part)});
    const DirectPoint& point = found.value()[0];
    sum += std::log(point.s75_pitch);
    squares += std::pow(point.standard_error_pitch / point.s75_pitch, 2);
  }
  return {std::exp(sum / parts) * sensor.ifov_mrad(), 100 * std::sqrt(squares) / parts};
}

}  // namespace todbench::testing
