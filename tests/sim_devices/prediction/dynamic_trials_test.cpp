// SPDX-License-Identifier: GPL-3.0-or-later
// A target that moves: what must equal a target that rests, what known transfer says, what summing gains.
#include "sim_devices/prediction/dynamic_trials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "hvs/observer/known_position.h"
#include "sim_devices/prediction/camera_trials.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/effect_exposure.h"
#include "sim_devices/sensor/effect_motion.h"
#include "sim_devices/sensor/image_chain.h"
#include "tests/sim_devices/reference.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

const std::vector<Level>& of(const DynamicTrials& trials, SequenceObserver kind) {
  return trials.levels[static_cast<std::size_t>(kind)];
}

double share(const std::vector<Level>& levels) {
  double correct = 0, total = 0;
  for (const auto& level : levels) correct += level.correct, total += level.total;
  return correct / total;
}

bool same(const std::vector<Level>& a, const std::vector<Level>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Level& x, const Level& y) {
    return x.size == y.size && x.correct == y.correct && x.total == y.total && x.cluster == y.cluster;
  });
}

TEST(DynamicTrials, OfATargetThatRestsAreThoseOfAStillPictureBitForBit) {
  TemplateObserver observer({}, triangle_alternatives());
  SensorSpec sensor = test::sc2000();
  sensor.time_constant_ms = 12;
  const auto still = camera_trials(sensor, {&observer},
                                   {.delta_t_k = 0.6,
                                    .sizes_pitch = {1.2, 1.8, 2.6},
                                    .presentations = 8,
                                    .frames = 4,
                                    .accuracy = Accuracy::draft(),
                                    .seed = 5});

  const auto found = dynamic_trials(sensor, observer,
                                    {.delta_t_k = 0.6,
                                     .sizes_pitch = {1.2, 1.8, 2.6},
                                     .speeds_mrad_s = {0},
                                     .passes = 8,
                                     .frames = 4,
                                     .accuracy = Accuracy::draft(),
                                     .seed = 5});

  ASSERT_TRUE(still && found);
  EXPECT_TRUE(same(of(found->front(), SequenceObserver::single_frame), still->observers.front().still.levels));
}

TEST(DynamicTrials, OfADetectorWithoutMemoryAreTheSameInASingleFrameAtEverySpeed) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec sensor = test::sc2000();
  const double rate_mrad_s = sensor.ifov_mrad() * sensor.frame_rate_hz;

  const auto found = dynamic_trials(sensor, observer,
                                    {.delta_t_k = 0.6,
                                     .sizes_pitch = {1.5, 2.2},
                                     .speeds_mrad_s = {0, 0.37 * rate_mrad_s, 2 * rate_mrad_s},
                                     .passes = 12,
                                     .frames = 6,
                                     .accuracy = Accuracy::draft()});

  ASSERT_TRUE(found) << found.error().message;
  const auto& rests = (*found)[0];
  EXPECT_NEAR((*found)[1].speed_px, 0.37, 1e-12);
  for (const auto& moving : *found)
    EXPECT_TRUE(same(of(moving, SequenceObserver::single_frame), of(rests, SequenceObserver::single_frame)));
  // 96 answers each. Six frames that are added at their places: less noise, more phases. Frames over ten pixels that
  // are averaged in one place: the target is gone, 25 % with a standard error of 4.4 %.
  EXPECT_GT(share(of((*found)[1], SequenceObserver::tracking_sum)),
            share(of(rests, SequenceObserver::single_frame)) + 0.05);
  EXPECT_LT(share(of((*found)[2], SequenceObserver::static_sum)), share(of(rests, SequenceObserver::static_sum)) - 0.2);
}

TEST(DynamicTrials, NeedMotionForSuperResolution) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec sensor = test::sc2000();
  const double rate_mrad_s = sensor.ifov_mrad() * sensor.frame_rate_hz;

  const auto found = dynamic_trials(sensor, observer,
                                    {.delta_t_k = 16.9,
                                     .sizes_pitch = {1.3, 1.6, 1.9},
                                     .speeds_mrad_s = {0, 0.5 * rate_mrad_s, rate_mrad_s},
                                     .passes = 30,
                                     .frames = 4,
                                     .accuracy = Accuracy::draft()});

  ASSERT_TRUE(found) << found.error().message;
  const double single = share(of((*found)[0], SequenceObserver::single_frame));
  const double rests = share(of((*found)[0], SequenceObserver::super_resolution));
  const double halves = share(of((*found)[1], SequenceObserver::super_resolution));
  const double whole = share(of((*found)[2], SequenceObserver::super_resolution));
  // 360 answers each: a difference has a standard error below sqrt(2 / 4 / 360) = 3.7 %.
  EXPECT_GT(halves, single + 0.08) << "half a pixel from frame to frame";
  EXPECT_NEAR(whole, rests, 0.08) << "a whole pixel shows no new place";
  EXPECT_LT(rests, halves - 0.08);
}

TEST(DynamicTrials, TrackedOverIdenticalFramesHaveTheNoiseOverTheRootOfTheirNumber) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  SensorSpec sensor = test::sc2000();
  sensor.netd_k = 0.2;
  DynamicTrialOptions options{.delta_t_k = 0.4,
                              .sizes_pitch = {1.4, 2.0},
                              .speeds_mrad_s = {0},
                              .passes = 80,
                              .frames = 4,
                              .accuracy = Accuracy::draft()};
  const auto four = dynamic_trials(sensor, observer, options);
  sensor.netd_k = 0.1;
  options.frames = 1;

  const auto one = dynamic_trials(sensor, observer, options);

  ASSERT_TRUE(four && one);
  const double summed = share(of(four->front(), SequenceObserver::tracking_sum));
  const double quiet = share(of(one->front(), SequenceObserver::single_frame));
  const double noisy = share(of(four->front(), SequenceObserver::single_frame));
  // 640 answers each: the difference has a standard error below sqrt(2 / 4 / 640) = 2.8 %.
  EXPECT_NEAR(summed, quiet, 4 * 0.028);
  EXPECT_GT(summed, noisy + 0.1);
}

TEST(DynamicTrials, OfABolometerLoseAcuityWithSpeed) {
  TemplateObserver observer({}, triangle_alternatives());
  SensorSpec sensor = test::sc2000();
  sensor.time_constant_ms = 20;  // a frame
  const double rate_mrad_s = sensor.ifov_mrad() * sensor.frame_rate_hz;

  const auto found = dynamic_trials(sensor, observer,
                                    {.delta_t_k = 2,
                                     .sizes_pitch = {1.3, 1.8},
                                     .speeds_mrad_s = {0, 0.75 * rate_mrad_s, 2 * rate_mrad_s},
                                     .passes = 24,
                                     .frames = 2,
                                     .accuracy = Accuracy::draft()});

  ASSERT_TRUE(found) << found.error().message;
  for (const auto kind : {SequenceObserver::single_frame, SequenceObserver::tracking_sum}) {
    EXPECT_GT(share(of((*found)[0], kind)), share(of((*found)[1], kind)));
    EXPECT_GT(share(of((*found)[1], kind)), share(of((*found)[2], kind)));
  }
}

TEST(DynamicTrials, BehindARecursiveFilterGainAtRestAndLoseWithSpeed) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  SensorSpec sensor = test::sc2000();
  sensor.netd_k = 0.2;
  const double rate_mrad_s = sensor.ifov_mrad() * sensor.frame_rate_hz;
  DynamicTrialOptions options{.delta_t_k = 0.4,
                              .sizes_pitch = {1.4, 2.0},
                              .speeds_mrad_s = {0},
                              .passes = 40,
                              .frames = 3,
                              .accuracy = Accuracy::draft()};
  const auto averaged = dynamic_trials(sensor, observer, options);
  options.frames = 1;
  options.speeds_mrad_s = {0, 0.5 * rate_mrad_s, 1.5 * rate_mrad_s};
  options.stages = [] {
    std::vector<std::unique_ptr<ChainStage>> stages;
    stages.push_back(recursive_filter(0.5));
    return stages;
  };

  const auto filtered = dynamic_trials(sensor, observer, options);

  ASSERT_TRUE(averaged && filtered);
  // (2 - a) / a = 3 frames. 320 answers each: the difference has a standard error below sqrt(2 / 4 / 320) = 4 %.
  const double rests = share(of((*filtered)[0], SequenceObserver::single_frame));
  EXPECT_NEAR(rests, share(of(averaged->front(), SequenceObserver::static_sum)), 4 * 0.04);
  EXPECT_GT(rests, share(of(averaged->front(), SequenceObserver::single_frame)));
  EXPECT_LT(share(of((*filtered)[1], SequenceObserver::single_frame)), rests);
  EXPECT_LT(share(of((*filtered)[2], SequenceObserver::single_frame)),
            share(of((*filtered)[1], SequenceObserver::single_frame)));
}

TEST(DynamicTrials, SmearByTheTransferOfTheReference) {
  const auto reference = nlohmann::json::parse(testing::content_of(source_file("tests/golden/measures/dynamic.json")));
  int compared = 0;
  for (const auto& example : reference["cases"]["motion"]) {
    const double speed = example["speed_pitch_per_frame"].get<double>();
    const double smear = speed * example["time_constant_frames"].get<double>();
    const double way = speed * example["integration_frames"].get<double>();
    EXPECT_NEAR(smear + way / 2, example["mean_lag_pitch"].get<double>(), 1e-12);
    for (std::size_t i = 0; i < example["frequency_per_pitch"].size(); ++i) {
      const double f = example["frequency_per_pitch"][i];
      const auto transfer = motion_transfer(f, 0, {smear, 0}) * exposure_transfer(f, 0, {way, 0});
      EXPECT_NEAR(std::abs(transfer), example["modulus"][i].get<double>(), 1e-8);
      // The mean lag is taken out, and the sign of the frequency is the other one.
      const double phase =
          -example["phase_rad"][i].get<double>() - 2 * std::numbers::pi * f * example["mean_lag_pitch"].get<double>();
      EXPECT_NEAR(std::arg(transfer), phase, 1e-8);
      ++compared;
    }
  }
  EXPECT_GE(compared, 18);
}

nlohmann::json dynamic_reference() {
  return nlohmann::json::parse(testing::content_of(source_file("tests/golden/measures/dynamic.json")))["cases"];
}

/// Answers of a stage to a single pixel of 1 in one of `frames` pictures of zeros, after one of zeros.
std::vector<double> impulse_in_time(ChainStage& stage, int frames) {
  std::vector<double> answers;
  (void)stage.process(cv::Mat1f(1, 1, 0.0F));
  for (int k = 0; k < frames; ++k)
    answers.push_back(static_cast<double>(stage.process(cv::Mat1f(1, 1, k == 0 ? 1.0F : 0.0F)).value()(0, 0)));
  return answers;
}

TEST(ChainStages, OfRecursionAreTheReference) {
  for (const auto& example : dynamic_reference()["recursive"]) {
    const auto stage = recursive_filter(example["weight"].get<double>());
    const auto answers = impulse_in_time(*stage, 400);
    double squares = 0, neighbours = 0, delay = 0, step = 0;
    int below = 0;
    for (std::size_t k = 0; k < answers.size(); ++k) {
      squares += answers[k] * answers[k];
      if (k + 1 < answers.size()) neighbours += answers[k] * answers[k + 1];
      delay += static_cast<double>(k) * answers[k];
      step += answers[k];
      if (step < 0.95) below = static_cast<int>(k) + 1;
      if (k < example["step_response"].size()) {
        EXPECT_NEAR(step, example["step_response"][k].get<double>(), 1e-6);
      }
    }
    EXPECT_NEAR(std::sqrt(squares), example["noise_sd_ratio"].get<double>(), 1e-6);
    EXPECT_NEAR(1 / squares, example["equivalent_frames"].get<double>(), 1e-4);
    EXPECT_NEAR(delay, example["mean_delay_frames"].get<double>(), 1e-4);
    EXPECT_NEAR(neighbours / squares, example["lag1_correlation"].get<double>(), 1e-6);
    if (!example["frames_to_5_percent"].is_null()) {
      EXPECT_EQ(below + 1, example["frames_to_5_percent"].get<int>());
    }
    for (const auto& [frequency, modulus] : example["modulus_at_cycles_per_frame"].items()) {
      std::complex<double> sum = 0;
      for (std::size_t k = 0; k < answers.size(); ++k)
        sum += std::polar(answers[k], -2 * std::numbers::pi * std::stod(frequency) * static_cast<double>(k));
      EXPECT_NEAR(std::abs(sum), modulus.get<double>(), 1e-6);
    }
  }
}

TEST(ChainStages, OfRecursionWithTheShareOfABolometerAreItsStepResponse) {
  for (const auto& example : dynamic_reference()["bolometer"]) {
    const double tau = example["time_constant_frames"];
    const double share = -std::expm1(-1 / tau);
    EXPECT_NEAR(share, example["recursive_weight"].get<double>(), 1e-10);
    EXPECT_NEAR(tau * std::log(100.0), example["frames_to_99_percent"].get<double>(), 1e-8);
    const auto stage = recursive_filter(share);
    double step = 0;
    const auto answers = impulse_in_time(*stage, 6);
    for (std::size_t k = 0; k < answers.size(); ++k) {
      step += answers[k];
      EXPECT_NEAR(step, example["step_fraction_after_frames"][k].get<double>(), 1e-6);
    }
  }
}

TEST(ChainStages, OfKernelsAreTheReference) {
  for (const auto& example : dynamic_reference()["kernels"]) {
    std::array<double, 9> kernel{};
    for (std::size_t i = 0; i < 9; ++i) kernel[i] = example["kernel"][i / 3][i % 3];
    cv::Mat1f impulse(9, 9, 0.0F);
    impulse(4, 4) = 1;
    const cv::Mat1f answer = kernel_filter(kernel)->process(impulse).value();
    const auto overlap = [&](int right, int down) {
      double sum = 0;
      for (int j = 0; j + down < 9; ++j) {
        for (int i = 0; i + right < 9; ++i)
          sum += static_cast<double>(answer(j, i)) * static_cast<double>(answer(j + down, i + right));
      }
      return sum;
    };
    EXPECT_NEAR(std::sqrt(overlap(0, 0)), example["noise_gain"].get<double>(), 1e-6);
    EXPECT_NEAR(overlap(1, 0) / overlap(0, 0), example["correlation_x1"].get<double>(), 1e-6);
    EXPECT_NEAR(overlap(1, 1) / overlap(0, 0), example["correlation_diagonal"].get<double>(), 1e-6);
    for (std::size_t k = 0; k < example["gain_along_x"].size(); ++k) {
      double gain = 0;
      for (int j = 0; j < 9; ++j) {
        for (int i = 0; i < 9; ++i)
          gain += static_cast<double>(answer(j, i)) *
                  std::cos(2 * std::numbers::pi * 0.1 * static_cast<double>(k) * (i - 4));
      }
      EXPECT_NEAR(gain, example["gain_along_x"][k].get<double>(), 1e-6);
    }
  }
}

TEST(ChainStages, OfGainControlAreTheReferenceLevelByLevel) {
  for (const auto& example : dynamic_reference()["histogram"]) {
    cv::Mat1f picture(example["rows"].get<int>(), example["columns"].get<int>());
    std::size_t at = 0;
    for (float& value : picture) value = example["picture"][at++].get<float>();
    const int plateau = example["plateau"].is_null() ? 0 : example["plateau"].get<int>();
    const cv::Mat1f answer = gain_control(plateau)->process(picture).value();
    std::set<float> levels(answer.begin(), answer.end());
    at = 0;
    for (const float value : answer) EXPECT_EQ(value, example["result"][at++].get<float>());
    EXPECT_EQ(levels.size(), example["distinct_levels"].get<std::size_t>());
  }
  // A plateau of one pixel counts each level once: equal steps.
  const cv::Mat1f clipped = gain_control(1)->process((cv::Mat1f(1, 4) << 7, 7, 7, 9)).value();
  EXPECT_EQ(clipped(0, 0), 128);
  EXPECT_EQ(clipped(0, 3), 255);
}

/// Right answers of the ideal observer at a known place: it knows the pictures of the four triangles behind a stage and
/// the covariance of the noise behind it.
double ideal_share(const std::array<cv::Mat1f, 4>& pictures, ChainStage& stage, double noise) {
  const int side = pictures[0].rows, samples = side * side;
  cv::Mat1d matrix(samples, samples);  // of the stage, column by column: the answer to a single pixel
  for (int i = 0; i < samples; ++i) {
    cv::Mat1f impulse(side, side, 0.0F);
    impulse(i / side, i % side) = 1;
    const cv::Mat1f answer = stage.process(impulse).value();
    for (int j = 0; j < samples; ++j) matrix(j, i) = static_cast<double>(answer(j / side, j % side));
  }
  const cv::Mat1d covariance = matrix * matrix.t();
  std::array<cv::Mat1d, 4> seen, whitened;
  for (std::size_t o = 0; o < 4; ++o) {
    cv::Mat1d values;
    stage.process(pictures[o]).value().reshape(1, samples).convertTo(values, CV_64F);
    seen[o] = values;
    cv::solve(covariance, seen[o], whitened[o], cv::DECOMP_CHOLESKY);
  }
  double sum = 0;
  for (std::size_t truth = 0; truth < 4; ++truth) {
    KnownPositionTask task{.noise = noise};
    for (std::size_t a = 0; a < 4; ++a) {
      const std::size_t o = (truth + a) % 4;  // the true one first
      task.mean[a] = whitened[o].dot(seen[truth]) - 0.5 * whitened[o].dot(seen[o]);
      for (std::size_t b = 0; b < 4; ++b) task.gram[a][b] = whitened[o].dot(seen[(truth + b) % 4]);
    }
    sum += probability_correct(task, 32) / 4;
  }
  return sum;
}

TEST(ChainStages, ThatAreLinearAndInvertibleLeaveTheIdealObserverAsItIs) {
  const SensorSpec sensor = test::sc2000();
  const ImageChain chain(sensor, full_plan(sensor, {}, {}), Accuracy::draft());
  std::array<cv::Mat1f, 4> pictures;
  for (std::size_t o = 0; o < 4; ++o)
    chain.image(triangle(1.6, all_apexes[o], {0.2, -0.1})).sample({-5, -5}, 1, {11, 11}).convertTo(pictures[o], CV_32F);
  const double noise = 0.2;
  const auto same = kernel_filter({0, 0, 0, 0, 1, 0, 0, 0, 0});
  const auto sharp = kernel_filter({0, -0.5, 0, -0.5, 3, -0.5, 0, -0.5, 0});
  const auto mean_taken_off = sharpening(2);
  const auto blur = kernel_filter({0.01, 0.04, 0.01, 0.04, 0.8, 0.04, 0.01, 0.04, 0.01});

  const double without = ideal_share(pictures, *same, noise);

  EXPECT_GT(without, 0.5);
  EXPECT_LT(without, 0.95);
  // Single precision of the answers, times the condition of the covariance: 100.
  for (ChainStage* stage : {sharp.get(), mean_taken_off.get(), blur.get()})
    EXPECT_NEAR(ideal_share(pictures, *stage, noise), without, 1e-4);
}

TEST(DynamicTrials, OfRowsThatAreReadOneAfterTheOtherAreJudgedWhereTheRowsAre) {
  // At 240 rows and 60 us a row almost nothing is lost at three pixels a frame; judged where all rows would be at
  // once, the outer triangles were one and a half pixels off and search would not reach them.
  TemplateObserver observer({}, triangle_alternatives());
  SensorSpec sensor = test::sc2000();
  const double rate_mrad_s = sensor.ifov_mrad() * sensor.frame_rate_hz;
  DynamicTrialOptions options{.delta_t_k = 2,
                              .sizes_pitch = {1.3, 1.8, 2.4, 3, 3.5, 4},
                              .speeds_mrad_s = {3 * rate_mrad_s},
                              .passes = 12,
                              .frames = 1,
                              .accuracy = Accuracy::draft()};
  const auto at_once = dynamic_trials(sensor, observer, options);
  sensor.row_time_us = 60;

  const auto by_rows = dynamic_trials(sensor, observer, options);

  ASSERT_TRUE(at_once && by_rows);
  // 288 answers each, the same noise: far below sqrt(2 / 4 / 288) = 4 %.
  EXPECT_NEAR(share(of(by_rows->front(), SequenceObserver::single_frame)),
              share(of(at_once->front(), SequenceObserver::single_frame)), 0.04);
}

/// Frames of the sensor model against the estimate without frames, which shares only the response to a triangle.
TEST(DynamicTrials, OfAnInterlacedFrameAreTheDirectEstimate) {
  TemplateObserver observer({}, triangle_alternatives());
  SensorSpec sensor = test::sc2000();
  sensor.field_delay_ms = 10;
  const double speed_mrad_s = 3 * sensor.ifov_mrad() * sensor.frame_rate_hz;  // 1.5 pitches between the fields
  const std::vector<double> sizes{1.8, 2.4, 3.2};
  const auto trials = dynamic_trials(sensor, observer,
                                     {.delta_t_k = 4,
                                      .sizes_pitch = sizes,
                                      .speeds_mrad_s = {speed_mrad_s},
                                      .passes = 96,
                                      .frames = 1,
                                      .accuracy = Accuracy::draft()});
  ASSERT_TRUE(trials);
  const auto expected = [&](const SensorSpec& spec) {
    DirectEstimateOptions options{.motion = {.x_mrad_s = speed_mrad_s, .y_mrad_s = 0}, .accuracy = Accuracy::draft()};
    options.accuracy.noise_draws = 400;
    const SensorPlan plan = full_plan(spec, {}, {}, options.motion);
    const ProportionCurve curve = proportion_curves(spec, plan, observer, {4}, options).value().front();
    double sum = 0;
    for (const double size : sizes) {
      const auto above =
          static_cast<std::size_t>(std::ranges::upper_bound(curve.sizes_pitch, size) - curve.sizes_pitch.begin());
      const double part = std::log(size / curve.sizes_pitch[above - 1]) /
                          std::log(curve.sizes_pitch[above] / curve.sizes_pitch[above - 1]);
      sum += std::lerp(curve.proportion_correct[above - 1], curve.proportion_correct[above], part);
    }
    return sum / static_cast<double>(sizes.size());
  };
  const double interlaced = expected(sensor);
  sensor.field_delay_ms = 0;

  // 1152 answers: four standard errors of at most 1.5 %, and 1 % for phases and draws.
  EXPECT_NEAR(share(of(trials->front(), SequenceObserver::single_frame)), interlaced, 0.07);
  EXPECT_GT(expected(sensor), interlaced + 0.1) << "fields cost acuity";
}

TEST(DynamicTrials, AreRefusedInASentence) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec sensor = test::sc2000();
  const DynamicTrialOptions fine{.delta_t_k = 2,
                                 .sizes_pitch = {2},
                                 .speeds_mrad_s = {1},
                                 .passes = 2,
                                 .frames = 1,
                                 .accuracy = Accuracy::draft()};
  const auto refused = [&](auto change) {
    DynamicTrialOptions options = fine;
    change(options);
    const auto found = dynamic_trials(sensor, observer, options);
    return !found && found.error().code == ErrorCode::invalid_input;
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& options) { options.delta_t_k = 0; }));
  EXPECT_TRUE(refused([](auto& options) { options.speeds_mrad_s = {-1}; }));
  EXPECT_TRUE(refused([](auto& options) { options.speeds_mrad_s = {std::nan("")}; }));
  EXPECT_TRUE(refused([](auto& options) { options.speeds_mrad_s = {1e6}; }));
  EXPECT_TRUE(refused([](auto& options) { options.sizes_pitch = {}; }));
  EXPECT_TRUE(refused([](auto& options) { options.frames = 0; }));
}

}  // namespace
}  // namespace todbench
