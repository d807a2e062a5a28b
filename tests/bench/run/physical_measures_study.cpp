// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of the measures of a session over many seeds: the figures of docs/validation/physical-measures.md.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <vector>

#include "tests/bench/run/bars_coverage.h"
#include "tests/bench/run/edge_coverage.h"
#include "tests/bench/run/mrtd_coverage.h"
#include "tests/bench/run/pixel_coverage.h"
#include "tests/bench/run/source_size_coverage.h"
#include "tests/bench/studies/graded_runs.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

// TODBENCH_STUDY_RUNS: seeds of ten edges each (40 without it).
TEST(PlateEdgesStudy, HoldTheMtfOfTheSensorModel) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const int seeds = asked != nullptr ? std::atoi(asked) : 40;
  struct Design {
    double aberration_pitch, f_number;
    testing::EdgeHalo halo{};
  };
  for (const Design& design :
       {Design{0, 1}, {0.35, 1}, {0.7, 1}, {0, 2}, {0.35, 4}, {0, 1, {0.05, 10}}, {0, 2, {0.02, 4}}}) {
    const auto coverage = testing::edge_coverage(design.aberration_pitch, seeds, design.f_number, design.halo);
    ASSERT_TRUE(coverage) << coverage.error().message;
    for (std::size_t k = 0; k < coverage->within.size(); ++k) {
      fmt::print("f/{} aberration {} pitch, halo {}, f {}: within {:.4f} of {} edges, mean error {:+.4f}\n",
                 design.f_number, design.aberration_pitch, design.halo.share, testing::EdgeCoverage::frequencies[k],
                 coverage->within[k], coverage->edges, coverage->mean_error[k]);
      EXPECT_GT(coverage->within[k], 0.95 - 4 * std::sqrt(0.05 * 0.95 / coverage->edges));
    }
    fmt::print("f/{} aberration {} pitch, halo {}: MTF 0.5 within {:.4f}\n", design.f_number, design.aberration_pitch,
               design.halo.share, coverage->half_within);
    EXPECT_GT(coverage->half_within, 0.95 - 4 * std::sqrt(0.05 * 0.95 / coverage->edges));
    std::fflush(stdout);
    EXPECT_EQ(coverage->single_sided, 0);
  }
}

// TODBENCH_STUDY_RUNS: seeds (60 without it).
TEST(MrtdStudy, HoldsTheVirtualMrtdOfTheSensor) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const auto found = testing::mrtd_coverage({0.2, 0.3, 0.4}, asked != nullptr ? std::atoi(asked) : 60, 6000, 0.002);
  ASSERT_TRUE(found) << found.error().message;
  for (const testing::MrtdCoverage& of : *found) {
    fmt::print("| {:g} | {:.4f} | {:.3f} | {:+.3f} | {:.3f} | {:.3f} | {:+.3f} |\n", of.frequency_per_pitch, of.truth_k,
               of.within, of.bias, of.half_width, of.best_within, of.best_bias);
    EXPECT_GT(of.within, 0.95 - 4 * std::sqrt(0.05 * 0.95 / of.intervals));
  }
}

/// A sample of 2.9 arcmin.
const ViewedDisplay bench_display{.pixel_pitch_mm = 0.25,
                                  .viewing_distance_m = 0.6,
                                  .luminance_white_cd_m2 = 200,
                                  .luminance_black_cd_m2 = 0.5,
                                  .zoom = 2};

/// Intervals of one frequency by hvs-2, over seeds and axes.
struct CoveredMrtd {
  int intervals = 0, missing = 0, within = 0, best_within = 0;
  double sum = 0, squares = 0, half_width = 0, best_sum = 0, lower = 0, upper = 0;
};

// TODBENCH_STUDY_RUNS: seeds (60 without it). TODBENCH_STUDY_FOLDER: where they are kept; a kept seed is not judged
// again. TODBENCH_STUDY_SHARE: "1/2", every second seed, for two processes at once. Rows are those of GradedRecord with
// kelvin in place of mrad and the frequency in place of the contrast.
TEST(MrtdStudy, HoldsTheVirtualMrtdByAnObserverWithAnEye) {
  const char *asked = std::getenv("TODBENCH_STUDY_RUNS"), *kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const testing::TemporaryFolder folder;
  const testing::StudyShare share = testing::study_share();
  testing::GradedRecord record((kept != nullptr ? std::filesystem::path(kept) : folder.path()) / "mrtd-hvs-2.csv",
                               share);
  const auto seeds = static_cast<std::uint64_t>(asked != nullptr ? std::atoi(asked) : 60);
  const std::vector<double> per_pitch{0.2, 0.3, 0.4};
  const TemplateObserverSpec observer = *load_observer_at("hvs-2", bench_display);
  const testing::MrtdRuns runs(per_pitch, 0.002, observer);
  for (std::uint64_t seed = share.first; seed <= seeds; seed += share.step) {
    if (record.has("hvs-2", seed)) continue;
    const auto bars = runs.bars(seed);
    ASSERT_TRUE(bars) << bars.error().message;
    std::vector<testing::GradedResult> rows;
    for (const MrtdPoint& point : *bars) {
      const auto add = [&](const char* what, const std::optional<double>& value, const Interval& ci95) {
        rows.push_back({"hvs-2", seed, point.frequency_per_pitch, what, value.value_or(0), ci95.low.value_or(0),
                        ci95.high.value_or(0)});
      };
      add("mean", point.threshold_k, point.ci95);
      add("best phase", point.best_phase_k, point.best_phase_ci95);
      if (point.spread_k) add("spread", point.threshold_k, {point.spread_k->first, point.spread_k->second});
    }
    record.append(rows);
  }
  if (share.step > 1) return;
  const auto truth = testing::true_mrtd(per_pitch, 2000, observer);
  ASSERT_TRUE(truth) << truth.error().message;
  for (const VirtualMrtdPoint& known : *truth) {
    CoveredMrtd of;
    const double frequency = known.frequency_per_mrad * load_sensor("sc2000")->ifov_mrad();
    for (const testing::GradedResult& row : record.rows()) {
      if (row.seed > seeds || std::abs(row.delta_t_k - frequency) > 0.01) continue;
      const auto holds = [&](double value) { return row.low_mrad <= value && value <= row.high_mrad ? 1 : 0; };
      if (row.estimator == "mean") {
        ++of.intervals;
        const bool found = row.s75_mrad > 0 && row.low_mrad > 0;
        of.missing += found ? 0 : 1;
        if (!found) continue;
        const double error = std::log(row.s75_mrad / known.threshold_k.value());
        of.within += holds(*known.threshold_k), of.sum += error, of.squares += error * error;
        of.half_width += 0.5 * std::log(row.high_mrad / row.low_mrad);
      } else if (row.estimator == "best phase" && row.s75_mrad > 0) {
        of.best_within += holds(known.best_phase_k.value());
        of.best_sum += std::log(row.s75_mrad / *known.best_phase_k);
      } else if (row.estimator == "spread") {
        of.lower += std::log(row.low_mrad / known.spread_k.value().first);
        of.upper += std::log(row.high_mrad / known.spread_k.value().second);
      }
    }
    ASSERT_GT(of.intervals, 0);
    const double n = of.intervals - of.missing, mean = of.sum / n;
    fmt::print(
        "| {:g} | {:.4f} +- {:.1f} % | {} of {} ({} without) | {:+.1f} % | {:.1f} % | {:.1f} % | {} | {:+.1f} % | "
        "{:+.1f} %, {:+.1f} % |\n",
        frequency, *known.threshold_k, 100 * known.relative_error, of.within, of.intervals, of.missing, 100 * mean,
        100 * std::sqrt(std::max(of.squares / n - mean * mean, 0.0)), 100 * of.half_width / n, of.best_within,
        100 * of.best_sum / n, 100 * of.lower / n, 100 * of.upper / n);
    std::fflush(stdout);
    EXPECT_EQ(of.missing, 0);
    EXPECT_GT(of.within, (0.95 - 4 * std::sqrt(0.05 * 0.95 / of.intervals)) * of.intervals);
  }
}

// TODBENCH_STUDY_RUNS: seeds of each design (200 without it).
TEST(SourceSizeStudy, HoldsTheClosedFormOfHalos) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const int seeds = asked != nullptr ? std::atoi(asked) : 200;
  struct Design {
    testing::SourceHalo halo;
    double f_number = 1, noise = 0.0015;
  };
  for (const Design& design :
       {Design{{0, 1}}, Design{{0.01, 3}}, Design{{0.05, 10}}, Design{{0.1, 4}}, Design{{0.03, 20}}, Design{{0.1, 50}},
        Design{{0.05, 10}, 2}, Design{{0.05, 10}, 1, 0.006}}) {
    const auto found = testing::source_size_coverage(design.halo, design.f_number, design.noise, seeds);
    ASSERT_TRUE(found) << found.error().message;
    for (std::size_t k = 0; k < found->sides_px.size(); ++k) {
      fmt::print("| {:g} % / {:g} px | {:g} | {:g} | {:g} | {:.4f} | {:+.4f} | {:.4f} | {:.3f} | {:.3f} |\n",
                 100 * design.halo.share, design.halo.sigma_px, design.f_number, design.noise, found->sides_px[k],
                 found->truth[k], found->mean_error[k], found->half_width[k], found->within[k], found->point_within[k]);
      EXPECT_GT(found->within[k], 0.93 - 4 * std::sqrt(0.05 * 0.95 / found->runs));
    }
    fmt::print("consistent in {:.3f} of {} runs\n", found->consistent, found->runs);
    std::fflush(stdout);
  }
}

TEST(PixelDefectsStudy, FindsWhatIsThereAndLittleElse) {
  const testing::PixelCamera cameras[] = {{}, {.frames = 48}, {.noise_correlation = 0.6}, {.kelvin_per_count = 0.06}};
  for (const testing::PixelCamera& camera : cameras) {
    testing::PixelCoverage sum;
    const std::uint64_t seeds = &camera == &cameras[0] ? 200 : 50;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) testing::add_pixel_coverage(sum, camera, seed);
    fmt::print("{} seeds, {} frames, correlation {}, {} K a count:", seeds, camera.frames, camera.noise_correlation,
               camera.kelvin_per_count);
    for (std::size_t k = 0; k < sum.there.size(); ++k)
      fmt::print(" {} {} of {},", to_string(pixel_fault_kinds[k]), sum.found[k], sum.there[k]);
    fmt::print(" substituted {} of {}; of {} live ones {} bad, {} substituted\n", sum.substituted_found,
               sum.substituted, sum.live, sum.bad_by_chance, sum.substituted_by_chance);
    for (std::size_t k = 0; k < sum.there.size(); ++k) EXPECT_GE(sum.found[k], 0.99 * sum.there[k]);
    EXPECT_GE(sum.substituted_found, 0.99 * sum.substituted);
    EXPECT_LE(sum.bad_by_chance + sum.substituted_by_chance, 4e-6 * sum.live);
  }
}

TEST(PlateBarsStudy, HoldTheCtfOfTheSensorModel) {
  for (const double aberration_pitch : {0.0, 0.35, 0.7}) {
    for (const double noise : {0.001, 0.004}) {
      SensorSpec sensor = *load_sensor("sc2000");
      sensor.aberration_sigma_pitch = aberration_pitch;
      const auto coverage = testing::bars_coverage(sensor, noise, 200, 20);
      ASSERT_TRUE(coverage) << coverage.error().message;
      fmt::print("aberration {} pitch, noise {}, far spread {:.4f}\n", aberration_pitch, noise, coverage->far_spread);
      for (const auto& group : coverage->groups) {
        fmt::print("  {:12} f {:.4f}", group.group, group.frequency_per_pitch);
        const double truths[] = {group.truth.best, group.truth.mean, group.truth.worst};
        for (std::size_t k = 0; k < 3; ++k) {
          fmt::print("  {:.4f} {:+.4f} +-{:.4f} {:.3f}", truths[k], group.mean_error[k], group.half_width[k],
                     group.within[k]);
          // 200 seeds: standard error 0.015. At four times the usual noise the extremes keep a bias.
          EXPECT_GT(group.within[k], noise > 0.002 ? 0.85 : 0.95 - 4 * 0.015) << group.group << ' ' << k;
        }
        fmt::print("\n");
      }
    }
  }
}

}  // namespace
}  // namespace todbench
