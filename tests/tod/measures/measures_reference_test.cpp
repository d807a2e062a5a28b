// SPDX-License-Identifier: GPL-3.0-or-later
// Signal transfer, noise of pixels, bad pixels, rounding and bars against the reference numbers.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/tod/measures/bar_modulation.h"
#include "tests/tod/measures/measures_reference.h"
#include "tod/measures/bad_pixels.h"
#include "tod/measures/pixel_noise.h"
#include "tod/measures/signal_transfer.h"

namespace todbench {
namespace {

std::vector<TemperatureStep> steps_of(const nlohmann::json& reference) {
  std::vector<TemperatureStep> steps;
  for (std::size_t i = 0; i < reference["delta_t_k"].size(); ++i)
    steps.push_back({reference["delta_t_k"][i], reference["counts"][i], reference["counts_se"][i].get<double>()});
  return steps;
}

TEST(SignalTransfer, GivesTheLinesOfTheReference) {
  for (const auto& reference : test::reference_cases("sitf_netd", "sitf")) {
    const auto line = signal_transfer(steps_of(reference)).value();

    // Ten digits of the reference.
    const auto near = [&](double value, const char* key) {
      EXPECT_NEAR(value, reference[key].get<double>(), 1e-9 * std::abs(reference[key].get<double>())) << key;
    };
    near(line.slope, "slope_counts_per_k");
    near(line.offset, "offset_counts");
    near(line.slope_u_stated.value(), "slope_se_from_stated");
    near(line.slope_u_scatter, "slope_se_from_scatter");
    near(line.chi2.value(), "chi_square");
    near(line.p.value(), "p_of_fit");
    near(line.largest_residual, "largest_residual_counts");
    near(line.nonlinearity_percent, "nonlinearity_percent_of_span");
    near(line.r_squared, "r_squared");
    EXPECT_EQ(line.degrees_of_freedom, reference["degrees_of_freedom"]);
    EXPECT_EQ(line.slope_u, std::max(*line.slope_u_stated, line.slope_u_scatter));
  }
}

TEST(SignalTransfer, RefusesStepsThatGiveNoLine) {
  const auto refused = [](std::vector<TemperatureStep> steps) { return !signal_transfer(steps); };
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused({{0, 1}, {1, 2}}));
  EXPECT_TRUE(refused({{2, 1}, {2, 2}, {2, 3}}));
  EXPECT_TRUE(refused({{0, 5}, {1, 5}, {2, 5}}));
  EXPECT_TRUE(refused({{0, 1, 0.1}, {1, 2}, {2, 3, 0.1}}));
  EXPECT_TRUE(refused({{0, 1, 0.0}, {1, 2, 0.1}, {2, 3, 0.1}}));
  EXPECT_TRUE(refused({{0, 1, -1.0}, {1, 2, 0.1}, {2, 3, 0.1}}));
  EXPECT_TRUE(refused({{0, std::nan("")}, {1, 2}, {2, 3}}));
  EXPECT_TRUE(refused({{0, 1, 1e-300}, {1, 2, 1e-300}, {2, 30, 1e-300}}));
  EXPECT_FALSE(refused({{0, 1, 1e-300}, {1, 2, 1e300}, {2, 3, 1e-300}}));
}

TEST(PixelNoise, GivesEveryDefinitionOfTheReference) {
  for (const auto& reference : test::reference_cases("sitf_netd", "netd")) {
    const auto noise = pixel_noise(test::frames_of<double>(reference)).value();

    const auto near = [&](double value, const char* key) {
      EXPECT_NEAR(value, reference[key].get<double>(), 1e-9 * std::abs(reference[key].get<double>())) << key;
    };
    near(noise.sd_rms, "temporal_sd_rms");
    near(noise.sd_rms_detrended, "temporal_sd_rms_detrended");
    near(noise.sd_frame_differences, "temporal_sd_frame_differences");
    near(noise.mean_of_pixel_sd, "mean_of_pixel_sd");
    near(noise.c4, "c4_of_frames");
    near(noise.mean_of_pixel_sd_corrected, "mean_of_pixel_sd_corrected");
    near(noise.median_pixel_sd, "median_pixel_sd");
    near(noise.sd_rms / reference["sitf_counts_per_k"].get<double>(), "netd_k");
    near(noise.fixed_pattern_variance, "fixed_pattern_variance_unbiased");
    EXPECT_NEAR(noise.sd_rms_ci95.first, reference["sd_rms_ci95"][0], 1e-8);
    EXPECT_NEAR(noise.sd_rms_ci95.second, reference["sd_rms_ci95"][1], 1e-8);
  }
}

TEST(PixelNoise, RefusesFramesThatAreNone) {
  const cv::Mat1d frame(2, 3, 1.0);
  EXPECT_FALSE(pixel_noise(std::vector<cv::Mat1d>{frame, frame}));
  EXPECT_FALSE(pixel_noise(std::vector<cv::Mat1d>{frame, frame, cv::Mat1d(3, 2, 1.0)}));
  EXPECT_FALSE(pixel_noise(std::vector<cv::Mat1d>{frame, frame, cv::Mat1d(2, 3, std::nan(""))}));
}

std::vector<std::vector<int>> places_of(const cv::Mat1b& mask) {
  std::vector<std::vector<int>> places;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (mask(y, x) != 0) places.push_back({y, x});
    }
  }
  return places;
}

TEST(BadPixels, FindsThoseOfTheReference) {
  for (const auto& reference : test::reference_cases("sitf_netd", "bad_pixels")) {
    const PixelProperties pixels{test::picture_of(reference["responsivity"]), test::picture_of(reference["offset"]),
                                 test::picture_of(reference["noise"])};

    const auto found = bad_pixels(pixels, {}).value();

    EXPECT_EQ(places_of(found.dead), reference["dead"].get<std::vector<std::vector<int>>>());
    EXPECT_EQ(places_of(found.noisy), reference["noisy"].get<std::vector<std::vector<int>>>());
    EXPECT_EQ(places_of(found.offset), reference["offset_bad"].get<std::vector<std::vector<int>>>());
    EXPECT_EQ(found.count, reference["bad_pixels"]);
    EXPECT_EQ(found.clusters, reference["clusters_of_two_or_more"]);
    EXPECT_EQ(found.largest_cluster, reference["largest_cluster"]);
    EXPECT_NEAR(found.operability_percent, reference["operability_percent"], 1e-9);
  }
}

TEST(BadPixels, RefusesWhatHasNoScale) {
  EXPECT_FALSE(bad_pixels({}, {}));
  EXPECT_FALSE(bad_pixels({.responsivity = cv::Mat1d::zeros(3, 3)}, {}));
  EXPECT_FALSE(bad_pixels({.noise_sd = cv::Mat1d::zeros(3, 3)}, {}));
  EXPECT_FALSE(bad_pixels({.responsivity = cv::Mat1d::ones(3, 3), .noise_sd = cv::Mat1d::ones(3, 4)}, {}));
}

/// Four bars of contrast 1 under a normal blur and a detector, sampled at one place: the blurred edge's integral over
/// the detector, edge by edge.
double four_bars_at(double x, double frequency, double detector, double sigma) {
  const auto integrated = [&](double t) {
    return t * 0.5 * std::erfc(-t / sigma / std::numbers::sqrt2) +
           sigma * std::exp(-0.5 * t * t / (sigma * sigma)) / std::sqrt(2 * std::numbers::pi);
  };
  double sum = 0;
  for (int edge = 0; edge < 8; ++edge) {
    const double from_edge = x - (edge - 3.5) / (2 * frequency);
    const double lit = (integrated(from_edge + detector / 2) - integrated(from_edge - detector / 2)) / detector;
    sum += edge % 2 == 0 ? lit : -lit;
  }
  return sum;
}

TEST(BarModulation, HasTheBestAndWorstPhaseOfTheReference) {
  for (const auto& reference : test::reference_cases("bars_sampled", "bars_sampled")) {
    const double frequency = reference["frequency_cycles_per_pitch"];
    const double first_at_best = reference["first_sample_at"], best_phase = reference["best_phase"];
    const int samples = static_cast<int>(reference["samples_at_best_phase"].size());
    double best = -1, worst = 2, mean = 0;
    int separated = 0;

    for (int i = 0; i < 64; ++i) {
      const double phase = (i + 0.5) / 64 - 0.5, first = first_at_best - best_phase + phase;
      std::vector<double> row;
      for (int k = -1; k <= samples; ++k)
        row.push_back(four_bars_at(first + k, frequency, reference["detector_pitch"], reference["blur_sigma_pitch"]));
      const auto found = bar_modulation(row, {frequency, first - 1}).value();
      best = std::max(best, found.modulation), worst = std::min(worst, found.modulation), mean += found.modulation / 64;
      separated += found.bars_separated == 4 ? 1 : 0;
    }

    EXPECT_NEAR(best, reference["modulation_best"], 1e-9);
    EXPECT_NEAR(worst, reference["modulation_worst"], 1e-9);
    EXPECT_NEAR(mean, reference["modulation_mean"], 1e-9);
    EXPECT_NEAR(separated / 64.0, reference["share_of_phases_with_four_bars"], 1e-12);
  }
}

TEST(BarModulation, ReadsTheSamplesOfTheReference) {
  for (const auto& reference : test::reference_cases("bars_sampled", "bars_sampled")) {
    const auto samples = reference["samples_at_best_phase"].get<std::vector<double>>();

    const auto found =
        bar_modulation(samples, {reference["frequency_cycles_per_pitch"], reference["first_sample_at"]}).value();

    EXPECT_NEAR(found.modulation, reference["modulation_best"], 1e-9);
    EXPECT_EQ(found.bars_separated, reference["bars_separated_best"]);
  }
}

TEST(BarModulation, RefusesBarsBeyondTheSamples) {
  const std::vector<double> samples(20, 0.5);
  EXPECT_FALSE(bar_modulation(samples, {0, -9.5}));
  EXPECT_FALSE(bar_modulation(samples, {0.1, -9.5}));
  EXPECT_FALSE(bar_modulation({}, {0.5, 0}));
  EXPECT_TRUE(bar_modulation(samples, {0.5, -9.5}));
}

}  // namespace
}  // namespace todbench
