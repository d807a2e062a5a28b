// SPDX-License-Identifier: GPL-3.0-or-later
// Four bars: the ideal observer against exact answers, the template observer against the closed form of known
// positions.
#include "sim_devices/prediction/virtual_mrtd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hvs/observer/identification_bank.h"
#include "sim_devices/prediction/bar_pattern.h"
#include "sim_devices/prediction/bar_profile.h"
#include "sim_devices/sensor/scene_image.h"
#include "tests/sim_devices/reference.h"
#include "tests/support/source_file.h"
#include "tod/range/bars_sampled.h"

namespace todbench {
namespace {

double sinc_of(double x) {
  return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

double gauss_and_detector(double f, double sigma, double detector) {
  return sinc_of(detector * f) * std::exp(-2 * std::pow(std::numbers::pi * sigma * f, 2));
}

TEST(IdealBars, AreTheExactAnswersOfTheReference) {
  std::ifstream file(source_file("tests/golden/reference_mrtd_ttp_shared.json"));
  const auto reference = nlohmann::json::parse(file);
  int cases = 0;
  for (const auto& c : reference["cases"]["four_bar"]) {
    const double sigma = c["blur_sigma_pitch"], detector = c["detector_pitch"];
    const BarPattern other = c["alternative"] == "five_bars" ? BarPattern::five_bars : BarPattern::uniform;

    const auto energies = bar_energies(
        c["frequency_cycles_per_pitch"], other,
        [&](double u, double w) -> std::complex<double> {
          return gauss_and_detector(u, sigma, detector) * gauss_and_detector(w, sigma, detector);
        },
        4, 16);

    double mean = 0;
    for (const double energy : energies) mean += energy / static_cast<double>(energies.size());
    EXPECT_NEAR(mean / c["energy_mean_over_phases"].get<double>(), 1, 1e-6) << c;
    EXPECT_NEAR(ideal_two_interval_contrast(energies, 0.75) / c["contrast_over_noise_75_two_interval"].get<double>(), 1,
                1e-6)
        << c;
    for (const auto& [contrast, proportion] : c["proportion_correct_two_interval"].items())
      EXPECT_NEAR(ideal_two_interval_proportion(energies, std::stod(contrast)), proportion.get<double>(), 1e-7) << c;
    ++cases;
  }
  EXPECT_GE(cases, 12);
}

TEST(BarProfile, SeesFourBarsAtThePhasesAtWhichTheSampledModulationDoes) {
  for (const double frequency : {0.2, 0.35, 0.45, 0.5, 0.55}) {
    const BlurredBars bars(
        frequency, [](double f) { return gauss_and_detector(f, 0.3, 0.895); }, 4);
    const int half = static_cast<int>(std::ceil(1.75 / frequency)) + 2;
    double share = 0;
    for (int i = 0; i < 64; ++i) {
      const double offset = (i + 0.5) / 64 - 0.5;
      std::vector<double> profile;
      for (int k = 0; k < 2 * half; ++k) profile.push_back(bars.at(k - half + 0.5 - offset));
      share += shallowest_gap(profile, frequency, offset) > 0 ? 1.0 / 64 : 0;
    }
    EXPECT_NEAR(share, bar_modulation(bars, 64).share_of_four, 1e-9) << frequency;
  }
}

VirtualMrtdTask sc2000_bars(std::vector<double> of_nyquist) {
  VirtualMrtdTask task;
  task.sensor = test::sc2000();
  task.sensor.fixed_pattern_k = 0;
  task.plan = full_plan(task.sensor, {}, {});
  task.accuracy = Accuracy::draft();
  for (const double share : of_nyquist) task.frequencies_per_mrad.push_back(share * 0.5 / task.sensor.ifov_mrad());
  task.draws = 800;
  return task;
}

// Without a search the difference of two scores is normal: P = Phi((m4 - m5) / (sd |T4 - T5| sqrt 2)), averaged over
// the phases of both intervals.
TEST(VirtualMrtd, OfKnownPositionsIsTheClosedForm) {
  VirtualMrtdTask task = sc2000_bars({0.7});
  task.observer.search_range_samples = 0;
  task.observer.internal_noise = 0;
  task.draws = 3000;
  const double f = 0.35;
  std::vector<AlternativeAspects> alternatives;
  for (const auto pattern : {BarPattern::four_bars, BarPattern::five_bars})
    alternatives.push_back({bar_edges(pattern, f, BarAxis::horizontal)});
  const auto bank = IdentificationBank::build(task.observer, alternatives, 1);
  ASSERT_TRUE(bank);
  const int side = bank->window_samples();
  double length = 0;
  for (int i = 0; i < side * side; ++i) {
    cv::Mat1f one = cv::Mat1f::zeros(side, side);
    one(i / side, i % side) = 1;
    const auto scores = bank->project(one);
    length += std::pow(static_cast<double>(scores[0] - scores[1]), 2);
  }
  const double noise_k = std::sqrt(task.sensor.netd_k * task.sensor.netd_k +
                                   task.sensor.kelvin_per_count * task.sensor.kelvin_per_count / 12);
  const SceneImager imager(task.sensor, task.plan, task.accuracy);
  std::vector<double> responses[2];
  for (int phase = 0; phase < 16; ++phase) {
    const cv::Point2d middle((side - 1) / 2.0 + (phase % 8 + 0.5) / 8 - 0.5,
                             (side - 1) / 2.0 + (phase / 8 + 0.5) / 2 - 0.5);
    for (std::size_t p = 0; p < 2; ++p) {
      cv::Mat1f seen;
      imager.image(placed(alternatives[p][0], 1, 0, middle), {side, side}).convertTo(seen, CV_32F);
      seen -= cv::mean(seen)[0];
      const auto scores = bank->project(seen);
      responses[p].push_back(static_cast<double>(scores[0] - scores[1]));
    }
  }
  const auto proportion = [&](double contrast_k) {
    double sum = 0;
    for (const double four : responses[0]) {
      for (const double five : responses[1])
        sum += 0.5 * std::erfc(-contrast_k * (four - five) / (noise_k * std::sqrt(length)) / 2);
    }
    return sum / 256;
  };
  double low = 1e-6, high = 10;
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(low * high);
    (proportion(middle) < 0.75 ? low : high) = middle;
  }

  const auto found = virtual_mrtd(task);

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->front().threshold_k);
  EXPECT_LT(found->front().relative_error, 0.05);
  // Four standard errors, and 2 % for the interpolation between contrasts.
  EXPECT_NEAR(std::log(*found->front().threshold_k / high), 0, 4 * found->front().relative_error + 0.02);
}

TEST(VirtualMrtd, IsBoundedByTheIdealObserverAndSpreadsWithThePhase) {
  const auto found = virtual_mrtd(sc2000_bars({0.3, 0.9}));

  ASSERT_TRUE(found) << found.error().message;
  for (const auto& point : *found) {
    ASSERT_TRUE(point.threshold_k && point.best_phase_k);
    EXPECT_GT(*point.threshold_k, point.ideal_k * (1 - 4 * point.relative_error));
    EXPECT_LE(*point.best_phase_k, *point.threshold_k * (1 + 4 * point.relative_error));
  }
  EXPECT_LT(*(*found)[0].worst_phase_k / *(*found)[0].best_phase_k, 1.3);
  // Next to Nyquist bars beat with the samples: the best phase is far from the worst.
  EXPECT_GT((*found)[1].worst_phase_k.value_or(1e9) / *(*found)[1].best_phase_k, 1.5);
}

// With a perfect eye the noise of the sensor is left: the ideal observer is a bound, and the gain has no effect. The
// operator sets the gain, so that the noise of the eye is in proportion to the contrast.
TEST(VirtualMrtd, OfAnEyeIsBoundedByTheIdealObserverAndFollowsItsLight) {
  VirtualMrtdTask task = sc2000_bars({0.3});
  task.draws = 400;
  const auto seen_by = [&](double luminance_cd_m2, double gain, double factor) {
    task.observer = {.name = "hvs-2",
                     .internal_noise = 0,
                     .sensor_noise_factor = factor,
                     .eye = EyeParameters{},
                     .window_margin_arcmin = 6,
                     .display = ViewedDisplay{.pixel_pitch_mm = 1000 * 2 * std::tan(3 / 120.0 * std::numbers::pi / 180),
                                              .viewing_distance_m = 1,
                                              .luminance_white_cd_m2 = 2 * luminance_cd_m2}};
    task.observer.eye->sensitivity *= gain;
    if (gain > 1) task.observer.eye->contrast_noise = 0;
    const auto found = virtual_mrtd(task);
    EXPECT_TRUE(found) << found.error().message;
    return found ? found->front() : VirtualMrtdPoint{};
  };

  const auto perfect = seen_by(50, 1e4, 1), same = seen_by(50, 1e5, 1);
  const auto seen = seen_by(50, 1, 1.75), dim = seen_by(0.5, 1, 1.75);

  ASSERT_TRUE(perfect.threshold_k && same.threshold_k && seen.threshold_k);
  EXPECT_NEAR(*perfect.threshold_k / *same.threshold_k, 1, 1e-3);
  EXPECT_GT(*perfect.threshold_k, perfect.ideal_k * (1 - 4 * perfect.relative_error));
  EXPECT_LT(*perfect.threshold_k, 3 * perfect.ideal_k);
  // 1.75 times the noise of the sensor, and the noise of the eye.
  EXPECT_GT(*seen.threshold_k, 1.6 * *perfect.threshold_k);
  EXPECT_GT(dim.threshold_k.value_or(1e9), *seen.threshold_k);
  ASSERT_TRUE(seen.spread_k);
  EXPECT_LT(seen.spread_k->first, *seen.threshold_k);
  EXPECT_GT(seen.spread_k->second, *seen.threshold_k);
}

TEST(VirtualMrtd, ResolvesBarsBehindDisplayAndEye) {
  VirtualMrtdTask task = sc2000_bars({0.3});
  task.draws = 400;
  task.criterion = BarCriterion::bars_resolved;
  const auto seen_at = [&](double arcmin, double gain, double factor) {
    task.observer = {
        .name = "hvs-2",
        .internal_noise = 0,
        .sensor_noise_factor = factor,
        .eye = EyeParameters{},
        .window_margin_arcmin = 6,
        .display = ViewedDisplay{.pixel_pitch_mm = 1000 * 2 * std::tan(arcmin / 120 * std::numbers::pi / 180),
                                 .viewing_distance_m = 1,
                                 .luminance_white_cd_m2 = 100}};
    task.observer.eye->sensitivity *= gain;
    if (gain > 1) task.observer.eye->contrast_noise = 0;
    const auto found = virtual_mrtd(task);
    EXPECT_TRUE(found) << found.error().message;
    return found ? found->front() : VirtualMrtdPoint{};
  };

  const auto perfect = seen_at(3, 1e4, 1), same = seen_at(3, 1e5, 1);
  const auto near_by = seen_at(3, 1, 1.75), far = seen_at(1.5, 1, 1.75), farther = seen_at(0.9, 1, 1.75);

  ASSERT_TRUE(perfect.threshold_k && same.threshold_k && near_by.threshold_k);
  EXPECT_NEAR(*perfect.threshold_k / *same.threshold_k, 1, 1e-3) << "the noise of the sensor alone";
  EXPECT_GT(*perfect.threshold_k, perfect.ideal_k);
  EXPECT_GT(*near_by.threshold_k, 1.6 * *perfect.threshold_k) << "1.75 times the noise of the sensor";
  EXPECT_GT(far.threshold_k.value_or(1e9), *near_by.threshold_k);
  EXPECT_GT(farther.threshold_k.value_or(2e9), far.threshold_k.value_or(1e9));
  ASSERT_TRUE(near_by.spread_k);
  EXPECT_LT(near_by.spread_k->first, *near_by.threshold_k);
  EXPECT_GT(near_by.spread_k->second, *near_by.threshold_k);
  std::printf("resolved: ideal %.4f, perfect eye %.4f, at 3' %.4f, at 1.5' %.4f, at 0.9' %.4f K\n", perfect.ideal_k,
              *perfect.threshold_k, *near_by.threshold_k, far.threshold_k.value_or(-1),
              farther.threshold_k.value_or(-1));
}

TEST(VirtualMrtd, NeedsMoreContrastToResolveThanToTellApart) {
  VirtualMrtdTask task = sc2000_bars({0.4, 1.4});
  const auto told = virtual_mrtd(task);
  task.criterion = BarCriterion::bars_resolved;
  const auto resolved = virtual_mrtd(task);

  ASSERT_TRUE(told && resolved);
  EXPECT_GT(*(*resolved)[0].threshold_k, *(*told)[0].threshold_k);
  // Beyond Nyquist a machine still tells alias patterns apart, but nobody sees four bars at a random phase.
  EXPECT_TRUE((*told)[1].threshold_k);
  EXPECT_FALSE((*resolved)[1].threshold_k);
}

TEST(VirtualMrtd, OfLinesAcrossDependsOnTheAxis) {
  VirtualMrtdTask task = sc2000_bars({0.4});
  task.sensor.column_noise_k = 0.2;
  task.plan = full_plan(task.sensor, {}, {});
  const auto horizontal = virtual_mrtd(task);
  task.axis = BarAxis::vertical;
  const auto vertical = virtual_mrtd(task);

  ASSERT_TRUE(horizontal && vertical);
  EXPECT_GT(*horizontal->front().threshold_k, 2 * *vertical->front().threshold_k);
}

/// Contrast times the pattern, and the noise of the draw.
TEST(VirtualMrtd, ShowsAPersonItsBarsAndItsNoise) {
  VirtualMrtdTask task;
  task.sensor = test::sc2000();
  task.plan = full_plan(task.sensor, {}, {});
  task.accuracy = Accuracy::draft();
  task.frequencies_per_mrad = {0.15, 0.3};
  const auto frames = BarFrames::of(task);
  ASSERT_TRUE(frames) << frames.error().message;
  const auto frame = [&](BarPattern pattern, double contrast_k, std::uint64_t draw) {
    return frames->frame_k(0, pattern, contrast_k, 5, draw);
  };
  const cv::Mat1f noise = frame(BarPattern::four_bars, 0, 3), one = frame(BarPattern::four_bars, 1, 3) - noise;
  const cv::Mat1f two = frame(BarPattern::four_bars, 2, 3) - noise;
  EXPECT_LT(cv::norm(two, 2 * one, cv::NORM_INF), 1e-5);
  EXPECT_GT(cv::norm(one, cv::NORM_INF), 0.3);
  EXPECT_GT(cv::norm(frame(BarPattern::five_bars, 1, 3) - noise, one, cv::NORM_INF), 0.3);
  EXPECT_GT(cv::norm(noise, frame(BarPattern::four_bars, 0, 4), cv::NORM_INF), task.sensor.netd_k);
  EXPECT_GT(frames->frame_k(0, BarPattern::four_bars, 1, 0, 0).cols,
            frames->frame_k(1, BarPattern::four_bars, 1, 0, 0).cols);
  EXPECT_GT(frames->ideal_k(1), frames->ideal_k(0));
}

TEST(VirtualMrtd, RefusesWhatHasNone) {
  VirtualMrtdTask silent = sc2000_bars({0.4});
  silent.sensor.netd_k = silent.sensor.row_noise_k = silent.sensor.column_noise_k = 0;
  silent.plan = full_plan(silent.sensor, {Effect::quantisation}, {});
  for (const auto& task : {silent, sc2000_bars({}), sc2000_bars({0.001}), sc2000_bars({4}), sc2000_bars({-1})}) {
    const auto found = virtual_mrtd(task);

    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  }
}

}  // namespace
}  // namespace todbench
