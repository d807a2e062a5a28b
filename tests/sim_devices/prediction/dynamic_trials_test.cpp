// A target that moves: what must equal a target that rests, what known transfer says, what summing gains.
#include "sim_devices/prediction/dynamic_trials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>

#include "sim_devices/prediction/camera_trials.h"
#include "sim_devices/sensor/effect_motion.h"
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
  EXPECT_TRUE(same(of(found->front(), SequenceObserver::single_frame), still->observers.front().still));
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
    if (example["integration_frames"] != 0.0) continue;
    const double smear = example["speed_pitch_per_frame"].get<double>() * example["time_constant_frames"].get<double>();
    for (std::size_t i = 0; i < example["frequency_per_pitch"].size(); ++i) {
      const double f = example["frequency_per_pitch"][i];
      const auto transfer = motion_transfer(f, 0, {smear, 0});
      EXPECT_NEAR(std::abs(transfer), example["modulus"][i].get<double>(), 1e-8);
      // The mean lag is taken out, and the sign of the frequency is the other one.
      const double phase =
          -example["phase_rad"][i].get<double>() - 2 * std::numbers::pi * f * example["mean_lag_pitch"].get<double>();
      EXPECT_NEAR(std::arg(transfer), phase, 1e-8);
      ++compared;
    }
  }
  EXPECT_GE(compared, 12);
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
