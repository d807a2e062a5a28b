// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of the true S75 over whole simulated runs, graded answers beside right and wrong ones of the same runs.
// TODBENCH_STUDY_FOLDER: where runs are kept; what is there is not made again. TODBENCH_STUDY_RUNS: how many of each
// design (600 and 200 without it). TODBENCH_STUDY_DESIGN: this one alone. TODBENCH_STUDY_SHARE: "1/2", every second
// run, for two processes at once. TODBENCH_STUDY_TRUTH: parts of 8000 draws behind the truth (3 without it). Prints the
// tables of docs/validation/coverage.md.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "tests/bench/studies/graded_runs.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {
namespace {

struct Studied {
  GradedDesign design;
  std::uint64_t runs = 200;
  std::uint64_t pairs = 0;  ///< of the first runs: beside the twin by common phases, for paired_comparison_study
};

SensorSpec with(void (*change)(SensorSpec&)) {
  SensorSpec sensor;
  change(sensor);
  return sensor;
}

/// A camera that is not as its twin.
Studied other_camera(const std::string& name, void (*change)(SensorSpec&)) {
  return {{.name = name, .camera = with(change), .twin = {}}};
}

/// Another camera and its twin, at the distance that suits the shipped plates.
Studied own_twin(const std::string& name, const std::vector<double>& delta_t_k,
                 const std::function<void(SensorSpec&)>& change) {
  SensorSpec sensor;
  change(sensor);
  return {
      {.name = name, .camera = sensor, .twin = sensor, .delta_t_k = delta_t_k, .distance_m = 2.6 / sensor.ifov_mrad()}};
}

/// Unlike the SC2000: 17 um, noise that the next frame remembers, pattern, rows, columns and a lens that blurs.
Studied uncooled_17_um() {
  return own_twin("uncooled 17 um", {10, 1, 0.2}, [](SensorSpec& s) {
    s.pitch_um = 17;
    s.detector_um = 15.3;
    s.focal_length_mm = 25;
    s.aberration_sigma_pitch = 0.25;
    s.netd_k = 0.05;
    s.noise_correlation = 0.3;
    s.fixed_pattern_k = 0.02;
    s.row_noise_k = 0.01;
    s.column_noise_k = 0.01;
  });
}

/// Limited by diffraction, little noise.
Studied cooled_f4() {
  return own_twin("cooled f/4", {5, 0.5, 0.08}, [](SensorSpec& s) {
    s.pitch_um = 15;
    s.detector_um = 14;
    s.focal_length_mm = 50;
    s.f_number = 4;
    s.wavelength_min_um = 3.4;
    s.wavelength_max_um = 5;
    s.netd_k = 0.02;
    s.kelvin_per_count = 0.004;
  });
}

/// Pixels that are higher or lower than wide, behind a lens that blurs.
Studied unlike_pitches(double pitch_y_um) {
  return own_twin("pitch 25 x " + std::to_string(std::lround(pitch_y_um)) + " um", {10, 1, 0.2}, [=](SensorSpec& s) {
    s.pitch_um = 25;
    s.detector_um = 22;
    s.pitch_y_um = pitch_y_um;
    s.detector_y_um = 0.85 * pitch_y_um;
    s.focal_length_mm = 25;
    s.aberration_sigma_pitch = 0.2;
    s.row_noise_k = 0.01;
  });
}

/// Judged by hvs-2 at a display: at 3.6 arcmin a sample the camera limits the acuity, at 1.8 arcmin the eye does.
Studied seen_by_an_eye(const std::string& name, Studied camera, double pixel_pitch_mm, double zoom) {
  camera.design.name = name;
  camera.design.display = ViewedDisplay{.pixel_pitch_mm = pixel_pitch_mm,
                                        .viewing_distance_m = 0.6,
                                        .luminance_white_cd_m2 = 120,
                                        .luminance_black_cd_m2 = 0.3,
                                        .zoom = zoom};
  return camera;
}

std::vector<Studied> designs() {
  const SensorSpec pattern = with([](SensorSpec& s) { s.fixed_pattern_k = 0.1; });
  const SensorSpec rounded = with([](SensorSpec& s) { s.kelvin_per_count = s.netd_k; });
  return {{default_design(), 600, 400},
          {{.name = "quarter", .phases = 3}},
          {{.name = "6 phases of 8 frames", .phases = 6, .frames = {8}}},
          {{.name = "demonstration by contrast", .phases = 6, .frames = {1, 2, 10}}},
          {{.name = "fixed pattern 0.1 K", .camera = pattern, .twin = pattern}},
          {{.name = "rounding to one sigma", .camera = rounded, .twin = rounded}},
          {{.name = "microscan", .microscan = 2}},
          uncooled_17_um(),
          cooled_f4(),
          unlike_pitches(20),
          unlike_pitches(32),
          seen_by_an_eye("eye, SC2000 at 2.4 arcmin", {default_design()}, 0.21, 2),
          seen_by_an_eye("eye, uncooled 17 um at 1.8 arcmin", uncooled_17_um(), 0.315, 1),
          seen_by_an_eye("eye, cooled f/4 at 3.6 arcmin", cooled_f4(), 0.21, 3),
          other_camera("noise 5 % above the twin", [](SensorSpec& s) { s.netd_k *= 1.05; }),
          other_camera("noise 20 % above the twin", [](SensorSpec& s) { s.netd_k *= 1.2; }),
          other_camera("f-number 20 % above the twin", [](SensorSpec& s) { s.f_number *= 1.2; }),
          other_camera("detector 5 % below the twin", [](SensorSpec& s) { s.detector_um *= 0.95; })};
}

TEST(GradedCoverage, OfTheTruthOverWholeRuns) {
  const TemporaryFolder temporary;
  const char* kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::string folder = kept != nullptr ? kept : temporary.path().string();
  const StudyShare share = study_share();
  GradedRecord record(folder + "/graded_runs.csv", share);
  std::printf(
      "| design | contrast | estimator | runs | bias | scatter | stated | half-width | 19 of 20 | predicted | coverage "
      "| "
      "second |\n");
  const char* only = std::getenv("TODBENCH_STUDY_DESIGN");
  const char* parts_of_truth = std::getenv("TODBENCH_STUDY_TRUTH");
  for (const auto& [design, all, pairs] : designs()) {
    if (only != nullptr && design.name != only) continue;
    const std::uint64_t runs = asked != nullptr ? std::strtoull(asked, nullptr, 10) : all;
    DesignParts parts(design);
    for (std::uint64_t seed = share.first; seed <= runs; seed += share.step)
      if (!record.has(design.name, seed)) record.append(results_of(parts, seed, seed <= pairs));
    const auto truths = true_sizes(design, design.delta_t_k, parts_of_truth != nullptr ? std::atoi(parts_of_truth) : 3);
    const auto predicted = predicted_half_widths(design);
    for (const double contrast : design.delta_t_k) {
      const TrueSize truth = truths.at(contrast);
      std::printf("| %s | %g K | truth | %.5f mrad | standard error %.3f %% |\n", design.name.c_str(), contrast,
                  truth.s75_mrad, truth.se_percent);
      for (const char* estimator : {"binary weibull", "binary twin-shape", "graded weibull", "graded twin-shape"}) {
        const GradedSummary s = summary_of(record.rows(), design.name, contrast, estimator, truth.s75_mrad);
        std::printf(
            "| %s | %g K | %s | %d | %+.3f %% | %.3f %% | %.3f %% | %.2f %% | %.2f %% | %.2f %% | %.3f | %.2f |\n",
            design.name.c_str(), contrast, estimator, s.runs, s.bias_percent, s.scatter_percent, s.stated_percent,
            s.half_width_percent, s.nineteen_of_20_percent, predicted.at(contrast), s.coverage, s.slope_fitted);
        std::fflush(stdout);
        if (std::string(estimator) != "graded twin-shape") continue;
        // 93 %, with three standard errors of so many runs.
        EXPECT_GT(s.coverage, 0.93 - 3 * std::sqrt(0.95 * 0.05 / s.runs)) << design.name << " " << contrast;
      }
    }
  }
}

/// What a plan has that says "binary" and nothing about the estimator.
TEST(DefaultCoverage, OfTheTruthOverWholeRuns) {
  const TemporaryFolder temporary;
  const char* kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const GradedDesign design{.name = "default"};
  GradedRecord record((kept != nullptr ? kept : temporary.path().string()) + std::string("/default_runs.csv"));
  const std::uint64_t runs = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 600;
  DesignParts parts(design);
  for (std::uint64_t seed = 1; seed <= runs; ++seed)
    if (!record.has(design.name, seed)) record.append(default_results_of(parts, seed));
  const auto truth = true_s75_mrad(design, {16.9, 1.93, 0.23}, 3);
  for (const double contrast : {16.9, 1.93, 0.23}) {
    for (const char* estimator : {"default weibull", "default"}) {
      const GradedSummary s = summary_of(record.rows(), design.name, contrast, estimator, truth.at(contrast));
      std::printf("| %g K | %s | %d | %+.2f %% | %.2f %% | %.2f %% | %.2f %% | %.3f |\n", contrast, estimator, s.runs,
                  s.bias_percent, s.scatter_percent, s.stated_percent, s.half_width_percent, s.coverage);
      if (std::string(estimator) == "default") {
        EXPECT_GT(s.coverage, 0.93 - 3 * std::sqrt(0.95 * 0.05 / s.runs)) << contrast;
      }
    }
  }
}

}  // namespace
}  // namespace todbench::testing
