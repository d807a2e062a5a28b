// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras with gain control: contrasts in grey levels from the large triangles of the frame that is judged.
#include "tod/measurement/grey_levels.h"

#include <gmock/gmock.h>

#include "tests/tod/measurement/grey_frames.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

TEST(GreyLevels, AreRoundedWithTheVarianceThatIsStated) {
  EXPECT_NEAR(rounding_variance(0), 1.0 / 12, 1e-12);
  for (const double noise : {0.1, 0.3, 0.5}) {
    // The mean of rounded normal values by integration over the noise, its variance over places of the true value.
    double squares = 0;
    constexpr int places = 200;
    for (int place = 0; place < places; ++place) {
      const double truth = (place + 0.5) / places;
      double mean = 0;
      for (int level = -6; level <= 7; ++level) {
        const auto below = [&](double x) { return 0.5 * std::erfc(-(x - truth) / noise / std::sqrt(2.0)); };
        mean += level * (below(level + 0.5) - below(level - 0.5));
      }
      squares += std::pow(mean - truth, 2) / places;
    }
    EXPECT_NEAR(rounding_variance(noise), squares, 1e-6) << noise;
  }
}

TEST(GreyLevels, HaveTheStepsOfTheCountsBehindThem) {
  cv::Mat1w lowest(60, 60), highest(60, 60);
  const RandomStream random(1, "steps");
  for (int i = 0; i < 3600; ++i) {
    // Counts with a noise of 2 behind a gain of 4.
    const auto level = [&](std::uint64_t k) {
      return static_cast<std::uint16_t>(100 + 4 * std::lround(2 * random.normal(k)));
    };
    const std::uint16_t a = level(static_cast<std::uint64_t>(2 * i)), b = level(static_cast<std::uint64_t>(2 * i + 1));
    lowest(i / 60, i % 60) = std::min(a, b);
    highest(i / 60, i % 60) = std::max(a, b);
  }

  const GreySteps steps = grey_steps(lowest, highest, 8);

  EXPECT_EQ(steps.step_levels, 4);
  EXPECT_NEAR(steps.noise_steps(), std::sqrt(4 - 1.0 / 12), 1e-12);
}

TEST(GreyLevels, HoldTheTruthAsOftenAsTheySay) {
  // Of 100 frames 95 with a standard deviation of 2.2: 88 and more are three of them.
  for (const test::GreyCase one : {test::GreyCase{16.9, 11}, test::GreyCase{1.93, 40}}) {
    const test::GreyCoverage found = test::grey_coverage(one, 100);

    EXPECT_EQ(found.frames, 100);
    EXPECT_GE(found.held, 88) << one.delta_t_k << " K";
    EXPECT_NEAR(found.mean_ratio, 1, 0.01);
  }
}

/// A camera whose gain is another one in every frame, and follows the contrast.
std::unique_ptr<test::DisturbedSource> restless(const test::SmallBench& bench, double levels_per_k) {
  auto source = std::make_unique<test::DisturbedSource>(
      bench.camera(), [&bench, levels_per_k](std::uint64_t index, Frame frame) -> Result<Frame> {
        const double gain =
            levels_per_k * bench.spec.kelvin_per_count * (1 + 0.1 * RandomStream(5, "gain").uniform(index));
        frame.counts = test::grey(frame.counts, gain, (300 - bench.spec.offset_k) / bench.spec.kelvin_per_count);
        frame.significant_bits = 8;
        frame.scale = std::make_shared<const RadiometricScale>();
        return frame;
      });
  SourceInfo info = bench.camera()->info();
  info.scale = {};
  source->pretend(std::move(info));
  return source;
}

MeasurementOptions grey_options(const test::SmallBench& bench) {
  MeasurementOptions options = test::options_of(bench);
  options.contrast_unit = ContrastUnit::grey_levels;
  return options;
}

TEST(GreyLevels, OfARestlessGainGiveTheAnswersOfTheKelvinThatTheyCameFrom) {
  test::SmallBench bench;
  bench.contrasts = {16.9};
  bench.phases = 12;
  const auto in_kelvin = bench.run(*bench.camera(), test::options_of(bench));
  const auto in_grey = bench.run(*restless(bench, 10), grey_options(bench));

  ASSERT_TRUE(in_kelvin && in_grey) << (in_grey ? "" : in_grey.error().message);
  ASSERT_FALSE(in_grey->ended_by) << in_grey->ended_by->message;
  ASSERT_EQ(in_grey->grey_frames.size(), 12u);
  ASSERT_EQ(in_grey->trials.size(), in_kelvin->trials.size());
  int same = 0;
  for (std::size_t i = 0; i < in_grey->trials.size(); ++i) {
    same += in_grey->trials[i].answer == in_kelvin->trials[i].answer ? 1 : 0;
    EXPECT_EQ(in_grey->trials[i].delta_t_k, 16.9) << "what the target says";
  }
  // Steps of 0.1 K beside 16.9 K: the same frames, noise and observer.
  EXPECT_GE(same, static_cast<int>(0.97 * static_cast<double>(in_grey->trials.size())));
  for (const GreyFrame& frame : in_grey->grey_frames) {
    const double gain = 10 * (1 + 0.1 * RandomStream(5, "gain").uniform(frame.frame));
    EXPECT_NEAR(frame.levels_per_k, gain, 0.05 * gain) << "5 %: the blur of the large triangles is not known here";
  }
  EXPECT_NEAR(in_grey->temporal_noise_k, in_kelvin->temporal_noise_k, 0.5 * in_kelvin->temporal_noise_k);
}

TEST(GreyLevels, AreRefusedWhereNothingSaysWhatTheyMean) {
  test::SmallBench bench;
  MeasurementOptions small = grey_options(bench);
  small.min_reference_px = 6;
  const auto too_small = bench.run(*restless(bench, 10), small);
  ASSERT_FALSE(too_small);
  EXPECT_EQ(too_small.error().code, ErrorCode::invalid_input);

  const auto in_kelvin = bench.run(*restless(bench, 10), test::options_of(bench));
  ASSERT_FALSE(in_kelvin);
  EXPECT_EQ(in_kelvin.error().code, ErrorCode::calibration);

  // Half a level at 16.9 K.
  const auto too_flat = bench.run(*restless(bench, 0.03), grey_options(bench));
  ASSERT_FALSE(too_flat);
}

TEST(GreyLevels, ThatAreCutOffAreTold) {
  test::SmallBench bench;
  bench.contrasts = {16.9};
  MeasurementOptions options = grey_options(bench);
  options.integrity.max_saturated_share = 0.2;

  const auto result = bench.run(*restless(bench, 20), options);  // 60 + 20 x 16.9 is above 255

  ASSERT_TRUE(result) << result.error().message;
  EXPECT_GT(tod_curve(result->trials, {})->points.at(0).saturated_share, 0.5);
}

}  // namespace
}  // namespace todbench
