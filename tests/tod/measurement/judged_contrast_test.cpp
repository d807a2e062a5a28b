// SPDX-License-Identifier: GPL-3.0-or-later
// Stages behind a camera may have a scale of their own: contrast and noise are those of the judged picture.
#include "tod/measurement/judged_contrast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "acquisition/base/rng.h"
#include "acquisition/core/forwarding_source.h"
#include "acquisition/core/judged_picture.h"
#include "tests/tod/measurement/known_answer.h"
#include "tod/plate/test_pattern.h"

namespace todbench::test {
namespace {

using Stage = std::function<cv::Mat1d(const cv::Mat1d& counts)>;

/// Puts a stage behind a camera: its answers, rounded to whole counts, are judged.
class StagedSource final : public ForwardingSource {
 public:
  StagedSource(std::unique_ptr<FrameSource> camera, Stage stage)
      : ForwardingSource(std::move(camera)), stage_(std::move(stage)) {}
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (!frame) return frame;
    cv::Mat1d counts;
    frame->counts.convertTo(counts, CV_64F);
    JudgedPicture judged;
    stage_(counts).convertTo(judged.counts, CV_16U);
    frame->judged = std::make_shared<const JudgedPicture>(std::move(judged));
    return frame;
  }

 private:
  Stage stage_;
};

/// A camera whose counts are fine against its noise: 1 mK, rounding of a third of it is 0.3 % of the noise's variance.
SimulatedBench fine_bench() {
  SimulatedBench bench;
  bench.spec.kelvin_per_count = 0.001;
  bench.spec.offset_k = 290;
  bench.spec.bits = 16;
  bench.plates = {two_plates().front()};
  bench.mountings = {Mounting::identity};
  bench.contrasts = {4, 0.6};
  bench.phases = 3;
  return bench;
}

MeasurementResult measured(const SimulatedBench& bench, Observer& observer, Stage stage, int settle_frames = 0) {
  PlateScene scene;
  scene.plate = bench.plates.front();
  scene.distance_m = bench.distance_m;
  const auto holder = std::make_shared<SceneHolder>(scene);
  const auto model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, bench.skip, {}),
                                                         Accuracy::draft(), bench.seed);
  StagedSource source(simulated_source(model, holder, "1"), std::move(stage));
  const auto target = scene_target(holder, bench.plates);
  ListedSchedule schedule = schedule_of(bench);
  MeasurementOptions options = options_of(bench);
  options.frames_after_change = settle_frames;
  auto result = measure(source, *target, observer, schedule, options, *bench.host, {}, {});
  EXPECT_TRUE(result) << result.error().message;
  return result ? *std::move(result) : MeasurementResult{};
}

cv::Mat1d as_it_is(const cv::Mat1d& counts) {
  return counts;
}

Stage affine(double gain, double offset_counts) {
  return [=](const cv::Mat1d& counts) { return cv::Mat1d(gain * counts + offset_counts); };
}

/// Share of trials with the same answer.
double agreement(const MeasurementResult& a, const MeasurementResult& b) {
  EXPECT_EQ(a.trials.size(), b.trials.size());
  double same = 0;
  for (std::size_t i = 0; i < std::min(a.trials.size(), b.trials.size()); ++i)
    same += a.trials[i].answer == b.trials[i].answer ? 1 : 0;
  return a.trials.empty() ? 0 : same / static_cast<double>(a.trials.size());
}

/// Largest difference of the scores, which are in units of the contrast.
double score_difference(const MeasurementResult& a, const MeasurementResult& b) {
  double largest = 0;
  for (std::size_t i = 0; i < std::min(a.trials.size(), b.trials.size()); ++i) {
    for (std::size_t o = 0; o < 4; ++o)
      largest = std::max(largest, std::abs(a.trials[i].scores[o] - b.trials[i].scores[o]));
  }
  return largest;
}

std::vector<std::unique_ptr<Observer>> observers() {
  std::vector<std::unique_ptr<Observer>> out;
  out.push_back(std::make_unique<TemplateObserver>(TemplateObserverSpec{}, triangle_alternatives()));
  TemplateObserverSpec human{.name = "human-like-1"};
  human.blur_sigma_samples = 0.5;
  human.internal_noise = 0.025;
  human.sensor_noise_factor = 1.75;
  out.push_back(std::make_unique<TemplateObserver>(human, triangle_alternatives()));
  out.push_back(std::make_unique<IdealObserver>("ideal", triangle_alternatives(), full_pitch_detector, 7));
  return out;
}

TEST(JudgedContrast, OfAGainAndAnOffsetLeavesEveryObserverWhereItWas) {
  const SimulatedBench bench = fine_bench();
  for (const auto& observer : observers()) {
    const MeasurementResult plain = measured(bench, *observer, as_it_is);
    for (const auto& [gain, offset] : {std::pair{0.3, 0.0}, {1.0, 5000.0}, {3.0, -5000.0}, {0.3, 5000.0}}) {
      const MeasurementResult behind = measured(bench, *observer, affine(gain, offset));

      // Rounding adds (0.29 counts / gain)^2 to the noise of 70 counts: 1e-4 of it. It changes only answers that two
      // alternatives share within 1 %: fewer than 1 in 50.
      EXPECT_GE(agreement(plain, behind), 0.98) << observer->name() << " " << gain << " " << offset;
      ASSERT_EQ(behind.judged_contrasts.size(), 2u);
      for (const JudgedContrast& judged : behind.judged_contrasts) {
        EXPECT_NEAR(judged.scale.gain, gain, 2e-3 * gain);
        EXPECT_FALSE(judged.scale.changes);
        EXPECT_NEAR(judged.judged_delta_t_k / judged.delta_t_k, gain, 2e-3 * gain);
        EXPECT_NEAR(judged.noise_k / plain.judged_contrasts.front().noise_k, 1, 2e-3);
      }
      // The contrast that is reported stays that of the camera.
      EXPECT_EQ(behind.trials.front().delta_t_k, plain.trials.front().delta_t_k);
    }
  }
}

TEST(JudgedContrast, OfUnchangedPicturesChangesNoScore) {
  const SimulatedBench bench = fine_bench();
  for (const auto& observer : observers()) {
    const auto plain = run(bench, *observer, options_of(bench),
                           std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, bench.skip, {}),
                                                               Accuracy::draft(), bench.seed));
    ASSERT_TRUE(plain) << plain.error().message;

    const MeasurementResult behind = measured(bench, *observer, as_it_is);

    EXPECT_EQ(score_difference(*plain, behind), 0) << observer->name();
    EXPECT_EQ(agreement(*plain, behind), 1);
  }
}

TEST(JudgedContrast, OfALinearFilterAndItsInverseChangesNothing) {
  const SimulatedBench bench = fine_bench();
  for (const auto& observer : observers()) {
    cv::Mat1d kept, last;
    const Stage both = [&](const cv::Mat1d& counts) {
      if (kept.empty()) kept = counts.clone();
      kept = 0.2 * counts + 0.8 * kept;
      const cv::Mat1d back = last.empty() ? kept.clone() : cv::Mat1d((kept - 0.8 * last) / 0.2);
      last = kept.clone();
      return back;
    };

    EXPECT_EQ(agreement(measured(bench, *observer, as_it_is), measured(bench, *observer, both)), 1) << observer->name();
  }
}

TEST(JudgedContrast, OfAGainThatChangesFromFrameToFrameIsThatOfEveryFrame) {
  const SimulatedBench bench = fine_bench();
  TemplateObserver observer(TemplateObserverSpec{}, triangle_alternatives());
  std::uint64_t n = 0;
  const RandomStream gains(7, "gains");
  const Stage changing = [&](const cv::Mat1d& counts) { return cv::Mat1d((0.5 + 2 * gains.uniform(n++)) * counts); };

  const MeasurementResult plain = measured(bench, observer, as_it_is), behind = measured(bench, observer, changing);

  ASSERT_EQ(behind.judged_contrasts.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const JudgedContrast& judged = behind.judged_contrasts[i];
    EXPECT_TRUE(judged.scale.changes);
    // Changes of the scene's contrast are no noise: at 4 K they are four times the noise. A difference of frames with
    // gains a and b has the noise of a gain of 2 a b / (a + b), rms 0.97 of the mean for gains of 0.5 to 2.5.
    EXPECT_NEAR(judged.noise_k / plain.judged_contrasts[i].noise_k, 1, 0.15);
  }
  // The contrast of one frame is known to 3 % at 0.6 K: only close decisions change.
  EXPECT_GE(agreement(plain, behind), 0.93);
}

TEST(JudgedContrast, TellsTheNoiseOfARecursiveFilter) {
  // A share of a fifth leaves a ninth of the variance; successive frames show a fifth of that.
  SimulatedBench bench = fine_bench();
  bench.contrasts = {4};
  TemplateObserver observer(TemplateObserverSpec{}, triangle_alternatives());
  cv::Mat1d kept;
  const Stage recursive = [&](const cv::Mat1d& counts) {
    if (kept.empty()) kept = counts.clone();
    kept = 0.2 * counts + 0.8 * kept;
    return kept.clone();
  };

  const MeasurementResult plain = measured(bench, observer, as_it_is, 31),
                          behind = measured(bench, observer, recursive, 31);

  ASSERT_EQ(behind.judged_contrasts.size(), 1u);
  // Eight pairs of 76800 pixels at each lag: a standard error of 0.2 %; and that of the gain, 1 %.
  EXPECT_NEAR(behind.judged_contrasts[0].noise_k / plain.judged_contrasts[0].noise_k, 1.0 / 3, 0.015);
}

/// Share of the trials in which a sample is at an end of the judged picture.
double saturated_share(const MeasurementResult& result) {
  double saturated = 0;
  for (const Trial& trial : result.trials) saturated += trial.saturated_pixels > 0 ? 1 : 0;
  return saturated / static_cast<double>(result.trials.size());
}

TEST(JudgedContrast, OfAStageThatCutsOffByItselfIsSaturated) {
  // The surround is at 10000 counts, the triangles at 14000 and 10600.
  SimulatedBench bench = fine_bench();
  TemplateObserver observer(TemplateObserverSpec{}, triangle_alternatives());
  const auto highest = [](double counts) {
    return [counts](const cv::Mat1d& picture) { return cv::Mat1d(cv::min(picture, counts)); };
  };
  const auto lowest_of_inverted = [](const cv::Mat1d& picture) {
    return cv::Mat1d(cv::max(20000.0 - picture, 8000.0));
  };
  bench.contrasts = {4};

  // The smallest triangles hardly reach an end through the blur.
  EXPECT_GT(saturated_share(measured(bench, observer, highest(11000))), 0.9);
  EXPECT_GT(saturated_share(measured(bench, observer, lowest_of_inverted)), 0.9);
  EXPECT_EQ(saturated_share(measured(bench, observer, highest(15000))), 0);
  EXPECT_EQ(saturated_share(measured(bench, observer, affine(0.3, 0))), 0);
  EXPECT_EQ(saturated_share(measured(bench, observer, affine(3, -5000))), 0);
}

TEST(JudgedContrast, OfAStageThatRoundsByItselfTellsItsSteps) {
  // 256 counts are 3.7 standard deviations of the noise.
  SimulatedBench bench = fine_bench();
  bench.contrasts = {4};
  TemplateObserver observer(TemplateObserverSpec{}, triangle_alternatives());
  const auto rounded = [](double step) {
    return [step](const cv::Mat1d& picture) {
      cv::Mat1d out = picture / step;
      for (double& value : out) value = step * std::round(value);
      return out;
    };
  };

  const auto coarse = measured(bench, observer, rounded(256)), fine = measured(bench, observer, rounded(16));

  EXPECT_LT(coarse.judged_contrasts.at(0).scale.steps.noise_steps(), 0.5);
  EXPECT_NEAR(fine.judged_contrasts.at(0).scale.steps.noise_steps(), 70.0 / 16, 0.3);
}

TEST(JudgedContrast, IsRefusedWhereTheStageShowsNone) {
  const SimulatedBench bench = fine_bench();
  TemplateObserver observer(TemplateObserverSpec{}, triangle_alternatives());
  PlateScene scene;
  scene.plate = bench.plates.front();
  scene.distance_m = bench.distance_m;
  const auto holder = std::make_shared<SceneHolder>(scene);
  const auto model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, bench.skip, {}),
                                                         Accuracy::draft(), bench.seed);
  StagedSource source(simulated_source(model, holder, "1"),
                      [](const cv::Mat1d& counts) { return cv::Mat1d(counts.size(), 5000.0); });
  const auto target = scene_target(holder, bench.plates);
  ListedSchedule schedule = schedule_of(bench);

  const auto result = measure(source, *target, observer, schedule, options_of(bench), *bench.host, {}, {});

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::not_identifiable);
  EXPECT_THAT(result.error().message, ::testing::HasSubstr("behind the stages"));
}

/// Pictures of noise: x_n = rho x_(n-1) + white, or a mean over `window` white ones.
double found_variance(double rho, int window, std::uint64_t seed) {
  const RandomStream stream(seed, "lag");
  LagDifferences differences(32);
  const cv::Size size(200, 200);
  std::vector<cv::Mat1d> white;
  cv::Mat1d memory = cv::Mat1d::zeros(size);
  std::uint64_t n = 0;
  for (int k = 0; k < 32 + 64; ++k) {
    cv::Mat1d draw(size);
    for (double& value : draw) value = stream.normal(n++);
    white.push_back(draw);
    memory = rho * memory + draw;
    if (k < 64) continue;
    cv::Mat1d mean = cv::Mat1d::zeros(size);
    for (int w = 0; w < window; ++w) mean += white[white.size() - 1 - static_cast<std::size_t>(w)] / window;
    differences.add(static_cast<std::uint64_t>(k), window > 1 ? mean : memory);
  }
  return differences.variance();
}

TEST(LagDifferences, KnowTheVarianceOfNoiseThatRemembers) {
  // Eight pairs of 40000 pixels: a standard error of 0.3 % at each lag, enlarged by 1 / (1 - rho^12).
  EXPECT_NEAR(found_variance(0, 1, 1), 1, 0.02);
  EXPECT_NEAR(found_variance(0.8, 1, 2) * (1 - 0.64), 1, 0.03);
  EXPECT_NEAR(found_variance(0.95, 1, 3) * (1 - 0.9025), 1, 0.12);
  EXPECT_NEAR(found_variance(0, 4, 4) * 4, 1, 0.02);
  EXPECT_NEAR(found_variance(0, 9, 5) * 9, 1, 0.03);
}

}  // namespace
}  // namespace todbench::test
