// SPDX-License-Identifier: GPL-3.0-or-later
// Runs whose camera stays as it is, and runs whose camera changes half-way.
#include "tod/measurement/run_constancy.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/measurement/lag_differences.h"
#include "tod/measures/temporal_noise.h"

namespace todbench {
namespace {

struct Camera {
  double place_k = 0.03;    ///< fixed pattern of a triangle's detectors
  double row_k = 0;         ///< pattern that the triangles of a set-up share
  double noise_k = 0.01;    ///< of a triangle in an average
  double second_plate = 1;  ///< what the second plate reads of a contrast: blur of another size
  double later_gain = 1;    ///< from the second half on
  std::vector<double> contrasts{16.9, 1.93, 0.23};
};

/// Two plates in four mountings, four large triangles each.
std::vector<ContrastMeasurement> run_of(const Camera& camera, std::uint64_t seed) {
  const RandomStream stream(seed, "constancy");
  std::uint64_t draw = 0;
  std::vector<ContrastMeasurement> out;
  for (int set_up = 0; set_up < 8; ++set_up) {
    const double shared_k = camera.row_k * stream.normal(draw++);
    const double gain = (set_up >= 4 ? camera.second_plate : 1) * (set_up >= 4 ? camera.later_gain : 1);
    std::vector<double> pattern_k;
    for (int i = 0; i < 4; ++i) pattern_k.push_back(camera.place_k * stream.normal(draw++));
    for (const double set_k : camera.contrasts) {
      ContrastMeasurement one{.set_delta_t_k = set_k, .references = {}};
      for (int i = 0; i < 4; ++i) {
        const double seen_k =
            gain * set_k + shared_k + pattern_k[static_cast<std::size_t>(i)] + camera.noise_k * stream.normal(draw++);
        one.references.push_back(
            {.value = seen_k, .place_px = {100.0 + 20 * i, set_up % 2 == 0 ? 120.0 : 205.0}, .size_px = 5});
        one.delta_t_k += seen_k / 4;
      }
      out.push_back(one);
    }
  }
  return out;
}

double share_found(const Camera& camera, int runs) {
  int found = 0;
  for (int k = 0; k < runs; ++k) {
    const auto change = transfer_change(run_of(camera, static_cast<std::uint64_t>(k)));
    found += change && change->beyond() ? 1 : 0;
  }
  return static_cast<double>(found) / runs;
}

TEST(TransferChange, HasFewFalseAlarmsOfCamerasThatStayAsTheyAre) {
  constexpr int runs = 2000;
  EXPECT_LE(share_found({}, runs), 0.01);
  EXPECT_LE(share_found({.row_k = 0.06}, runs), 0.01);
  EXPECT_LE(share_found({.second_plate = 1.01}, runs), 0.01);
  EXPECT_LE(share_found({.contrasts = {16.9}}, runs), 0.01);
  EXPECT_LE(share_found({.contrasts = {0.23}}, runs), 0.01);
  EXPECT_LE(share_found({.row_k = 0.03, .contrasts = {0.5}}, runs), 0.01);
}

TEST(TransferChange, FindsAGainOfATenthMore) {
  EXPECT_GE(share_found({.later_gain = 1.1}, 200), 0.99);
  EXPECT_GE(share_found({.row_k = 0.06, .later_gain = 0.9}, 200), 0.99);
  EXPECT_GE(share_found({.later_gain = 1.1, .contrasts = {16.9}}, 200), 0.99);
}

TEST(TransferChange, SaysByHowMuch) {
  const auto change = transfer_change(run_of({.later_gain = 1.1}, 7));
  ASSERT_TRUE(change);
  // Pattern cancels; 0.01 K of noise over 16.67 K in 16 triangles on each side: 0.03 %.
  EXPECT_NEAR(change->value, 0.1, 0.002);
}

TEST(TransferChange, LeavesOutSetUpsThatSawSmallContrastsAlone) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    auto run = run_of({.row_k = 0.06}, seed);
    // The last set-up saw 0.23 K only, as where a camera was lost or a schedule adapts.
    run.erase(run.end() - 3, run.end() - 1);
    const auto change = transfer_change(run);
    found += change && change->beyond() ? 1 : 0;
  }
  EXPECT_LE(found, 20);
}

TEST(TransferChange, OfOneSetUpIsNotKnown) {
  const auto run = run_of({}, 1);
  EXPECT_FALSE(transfer_change(std::span(run).first(3)));
}

TEST(NoiseChange, ComparesPicturesOfTheSameContrast) {
  const std::vector<PictureNoise> more_signal{{16.9, 0.080, 0.0}, {0.23, 0.060, 0.0}, {16.9, 0.081, 0.01}};
  EXPECT_FALSE(noise_change(more_signal)->beyond());
  EXPECT_FALSE(correlation_change(more_signal)->beyond());
  const std::vector<PictureNoise> added{{16.9, 0.071, 0.0}, {0.23, 0.071, 0.0}, {16.9, 0.071, 0.0}, {0.23, 0.8, 0.0}};
  ASSERT_TRUE(noise_change(added)->beyond());
  EXPECT_NEAR(noise_change(added)->value, std::log(0.8 / 0.071), 1e-9);
  const std::vector<PictureNoise> filtered{{16.9, 0.071, 0.0}, {16.9, 0.041, 0.5}};
  EXPECT_TRUE(noise_change(filtered)->beyond());
  EXPECT_TRUE(correlation_change(filtered)->beyond());
}

TEST(NoiseChange, OfOnePictureOfEachContrastIsNotKnown) {
  EXPECT_FALSE(noise_change(std::vector<PictureNoise>{{16.9, 0.07, 0.0}, {0.23, 0.8, 0.0}}));
}

/// Noise of an average of small frames, half of its variance that of whole rows; `memory`: correlation of successive
/// frames.
struct SmallAverage {
  int frames = 4, rows = 24, columns = 32;
  double noise_k = 0.07, memory = 0;
  double restless = 0;  ///< half of the range of the frames' gains about 1; the scene has a contrast of 16.9 K
};

/// Estimated like in an average of a run: differences without the change of the whole frame.
PictureNoise noise_of(const SmallAverage& average, const RandomStream& stream) {
  std::uint64_t draw = 0;
  const double sd = average.noise_k / std::sqrt(2.0), fresh = std::sqrt(1 - average.memory * average.memory);
  std::vector<cv::Mat1d> seen;
  for (int k = 0; k < average.frames; ++k) {
    cv::Mat1d frame(average.rows, average.columns);
    for (int y = 0; y < average.rows; ++y) {
      const double row = stream.normal(draw++);
      for (int x = 0; x < average.columns; ++x) frame(y, x) = sd * (row + stream.normal(draw++));
    }
    seen.push_back(k == 0 ? frame : cv::Mat1d(average.memory * seen.back() + fresh * frame));
  }
  const FrameGain gain = average.restless > 0 ? FrameGain::changing : FrameGain::constant;
  if (gain == FrameGain::changing) {
    for (cv::Mat1d& frame : seen) {
      frame = frame.clone();
      frame(cv::Rect(8, 8, 8, 8)) += 16.9;
      frame *= 1 + average.restless * (2 * stream.uniform(draw++) - 1);
    }
  }
  const auto mean_square = [&](int lag) {
    double sum = 0;
    for (std::size_t k = static_cast<std::size_t>(lag); k < seen.size(); ++k) {
      cv::Scalar mean, deviation;
      cv::meanStdDev(difference_of(seen[k - static_cast<std::size_t>(lag)], seen[k], gain), mean, deviation);
      sum += deviation[0] * deviation[0] / 2;
    }
    return sum / (average.frames - lag);
  };
  const int lag = std::min(8, average.frames / 4);
  PictureNoise out{.set_delta_t_k = 16.9,
                   .noise_k = std::sqrt(mean_square(1)),
                   .frames = average.frames,
                   .lines = std::min(average.rows, average.columns)};
  if (lag >= 2) out.lag1_correlation = first_order_correlation(mean_square(lag) / mean_square(1), lag);
  return out;
}

struct ChangesFound {
  int noise = 0, correlation = 0;
};

/// Runs of two averages.
ChangesFound changes_found(const SmallAverage& first, const SmallAverage& later, std::uint64_t runs) {
  ChangesFound found;
  for (std::uint64_t seed = 0; seed < runs; ++seed) {
    const RandomStream stream(seed, "small average");
    const std::vector<PictureNoise> run{noise_of(first, stream.sub(0)), noise_of(later, stream.sub(1))};
    const auto correlation = correlation_change(run);
    found.noise += noise_change(run)->beyond() ? 1 : 0;
    found.correlation += correlation && correlation->beyond() ? 1 : 0;
  }
  return found;
}

// With limits for 16 frames of 120 rows, 4 % of the right runs with four frames were called changed.
TEST(NoiseChange, HasFewFalseAlarmsOfFewFramesOfASmallPicture) {
  for (const int frames : {2, 4, 8, 16}) {
    const SmallAverage same{.frames = frames};
    const ChangesFound found = changes_found(same, same, 2000);
    EXPECT_LE(found.noise, 2) << frames;
    EXPECT_LE(found.correlation, 2) << frames;
  }
}

// A change of the gain by 5 % is 0.2 K rms over the picture, three times the noise.
TEST(NoiseChange, OfFramesOfAnotherGainIsThatOfTheirNoise) {
  const SmallAverage same{.frames = 8, .restless = 0.05};
  const ChangesFound found = changes_found(same, same, 500);
  EXPECT_LE(found.noise, 1);
  EXPECT_LE(found.correlation, 1);
  EXPECT_NEAR(noise_of(same, RandomStream(1, "one")).noise_k, 0.07, 0.02);
  EXPECT_GE(changes_found(same, {.frames = 8, .noise_k = 0.14, .restless = 0.05}, 100).noise, 99);
}

/// Noise of the averages of a camera in grey levels, each divided by the mean of its triangles.
std::vector<PictureNoise> grey_noise_of(const Camera& camera, std::size_t triangles, std::uint64_t seed) {
  const RandomStream stream(seed, "grey constancy");
  std::uint64_t draw = 0;
  std::vector<PictureNoise> out;
  for (const ContrastMeasurement& one : run_of(camera, seed)) {
    std::vector<double> seen_k;
    for (std::size_t i = 0; i < triangles; ++i) seen_k.push_back(one.references[i].value);
    const cv::Mat1d all(seen_k);
    cv::Scalar mean, sd;
    cv::meanStdDev(all, mean, sd);
    const auto n = static_cast<double>(triangles);
    // 16 frames of 120 lines: a standard error of 1.0 %.
    const double noise_k = (out.size() >= 12 ? camera.later_gain : 1) * 0.07 * std::exp(0.01 * stream.normal(draw++));
    out.push_back({.set_delta_t_k = one.set_delta_t_k,
                   .noise_k = noise_k * one.set_delta_t_k / mean[0],
                   .triangles = static_cast<int>(triangles),
                   .triangle_scatter = sd[0] * std::sqrt(n / (n - 1)) / mean[0]});
  }
  return out;
}

double share_of_grey_noise_found(const Camera& camera, std::size_t triangles, int runs) {
  int found = 0;
  for (int k = 0; k < runs; ++k)
    found += noise_change(grey_noise_of(camera, triangles, static_cast<std::uint64_t>(k)))->beyond() ? 1 : 0;
  return static_cast<double>(found) / runs;
}

TEST(NoiseChange, InGreyLevelsHasFewFalseAlarmsOfCamerasThatStayAsTheyAre) {
  constexpr int runs = 2000;
  for (const std::size_t triangles : {std::size_t{2}, std::size_t{4}}) {
    EXPECT_LE(share_of_grey_noise_found({}, triangles, runs), 0.01) << triangles;
    EXPECT_LE(share_of_grey_noise_found({.row_k = 0.03}, triangles, runs), 0.01) << triangles;
    EXPECT_LE(share_of_grey_noise_found({.second_plate = 1.02}, triangles, runs), 0.01) << triangles;
    EXPECT_LE(share_of_grey_noise_found({.contrasts = {16.9}}, triangles, runs), 0.01) << triangles;
    EXPECT_LE(share_of_grey_noise_found({.contrasts = {0.23}}, triangles, runs), 0.01) << triangles;
  }
}

TEST(NoiseChange, InGreyLevelsIsNoChangeOfTheGain) {
  // Contrast and noise change alike.
  EXPECT_LE(share_of_grey_noise_found({.later_gain = 1.5}, 4, 2000), 0.01);
}

TEST(NoiseChange, InGreyLevelsFindsTwiceTheNoise) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    auto run = grey_noise_of({}, 4, seed);
    for (std::size_t i = 12; i < run.size(); ++i) run[i].noise_k *= 2;
    found += noise_change(run)->beyond() ? 1 : 0;
  }
  EXPECT_GE(found, 198);
}

TEST(NoiseChange, FindsTwiceTheNoiseAndAFilterInASmallPicture) {
  EXPECT_GE(changes_found({}, {.noise_k = 0.14}, 200).noise, 198);
  EXPECT_GE(changes_found({.frames = 16}, {.frames = 16, .memory = 0.7}, 200).correlation, 198);
}

// The limits are 15 % and 0.2, the errors 1.4 % and 0.026.
TEST(NoiseChange, FindsAFifthMoreNoiseAndACorrelationOfAThirdInALargePicture) {
  const SmallAverage large{.frames = 16, .rows = 120, .columns = 120};
  SmallAverage noisy = large, filtered = large;
  noisy.noise_k *= 1.2;
  filtered.memory = 0.33;
  EXPECT_GE(changes_found(large, noisy, 30).noise, 29);
  EXPECT_GE(changes_found(large, filtered, 30).correlation, 29);
}

TEST(NoiseChange, HasTheLimitsOfSixteenFramesOfALargePicture) {
  const std::vector<PictureNoise> large{{16.9, 0.07, 0.0}, {16.9, 0.07, 0.0}};
  EXPECT_EQ(noise_change(large)->limit, most_noise_change);
  EXPECT_EQ(correlation_change(large)->limit, most_correlation_change);
  // Two frames: 5 sqrt(2 / 4 * 2 (1/480 + 1/57600)) by hand.
  const std::vector<PictureNoise> two{{16.9, 0.07, {}, 2}, {16.9, 0.07, {}, 2}};
  EXPECT_NEAR(noise_change(two)->limit, 5 * std::sqrt(1.0 / 480 + 1.0 / 57600), 1e-12);
}

/// The first frame of an average has `share` of the picture before.
struct Change {
  double share = 0, noise_k = 0.07, step_k = 15;
};

std::optional<PictureResidue> residue_of(const Change& change, std::uint64_t seed) {
  constexpr int frames = 16, side = 32;
  const RandomStream stream(seed, "residue");
  std::uint64_t draw = 0;
  cv::Mat1d before(side, side, 0.0), first, last, mean(side, side, 0.0);
  before(cv::Rect(20, 20, 12, 12)) = change.step_k;
  for (int k = 0; k < frames; ++k) {
    cv::Mat1d frame(side, side);
    for (double& pixel : frame) pixel = change.noise_k * stream.normal(draw++);
    if (k == 0) frame += change.share * before;
    if (k == 0) first = frame.clone();
    last = frame;
    mean += frame / frames;
  }
  return picture_residue(before, first, last, mean, change.noise_k);
}

TEST(PictureResidue, IsTheShareOfTheOldPictureInTheFirstFrame) {
  const auto residue = residue_of({.share = 0.5}, 1);
  ASSERT_TRUE(residue);
  // The mean of 16 frames has a sixteenth of it: 0.5 / (1 - 0.5 / 16). Noise: 0.07 sqrt(2) / (15 * 12) = 0.0006.
  EXPECT_NEAR(residue->share, 0.5 / (1 - 0.5 / 16), 0.003);
  EXPECT_GT(residue->share, residue->limit);
}

TEST(PictureResidue, HasFewFalseAlarmsOfAPictureThatRests) {
  int found = 0, judged = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    // A small contrast: the error of a share is 0.026.
    const auto residue = residue_of({.share = 0, .noise_k = 0.07, .step_k = 0.35}, seed);
    judged += residue ? 1 : 0;
    found += residue && residue->share > residue->limit ? 1 : 0;
  }
  EXPECT_EQ(judged, 2000);
  EXPECT_LE(found, 20);
}

TEST(PictureResidue, FindsThreePerCentOfTheOldPicture) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto residue = residue_of({.share = 0.03}, seed);
    found += residue && residue->share > residue->limit ? 1 : 0;
  }
  EXPECT_GE(found, 198);
}

TEST(PictureResidue, OfPicturesThatDoNotDifferIsNotKnown) {
  EXPECT_FALSE(residue_of({.share = 0, .noise_k = 0.07, .step_k = 0.01}, 1));
}

/// Judged pictures of an average: counts of a square of 1500 after another square of 1500.
struct JudgedPictures {
  double noise = 7;
  int delay = 0;            ///< pictures that still show the previous scene
  double memory = 0;        ///< share of the previous picture in each picture
  double pulsation = 0;     ///< standard deviation of a gain of each picture
  double noise_memory = 0;  ///< correlation of the noise of successive pictures
  double step = 1500;
};

std::optional<PictureResidue> judged_residue_of(const JudgedPictures& change, std::uint64_t seed) {
  constexpr int frames = 16, side = 32;
  const RandomStream stream(seed, "judged residue");
  std::uint64_t draw = 0;
  cv::Mat1d scene(side, side, 5000.0), old(side, side, 5000.0), noise(side, side, 0.0), shown;
  scene(cv::Rect(2, 2, 12, 12)) += change.step;
  old(cv::Rect(18, 18, 12, 12)) += change.step;
  cv::Mat1d before(side, side, 0.0), mean(side, side, 0.0);
  std::vector<cv::Mat1w> pictures;
  for (int k = -frames; k < frames; ++k) {
    for (double& pixel : noise)
      pixel = change.noise_memory * pixel +
              std::sqrt(1 - change.noise_memory * change.noise_memory) * change.noise * stream.normal(draw++);
    const double gain = 1 + change.pulsation * stream.normal(draw++);
    const cv::Mat1d now = (k < change.delay ? old : scene);
    shown = shown.empty() ? now.clone() : cv::Mat1d(change.memory * shown + (1 - change.memory) * now);
    cv::Mat1w counts;
    cv::Mat1d((shown - 5000) * gain + 5000 + noise).convertTo(counts, CV_16U);
    (k < 0 ? before : mean) += cv::Mat1d(counts) / frames;
    if (k >= 0) pictures.push_back(counts);
  }
  return judged_residue(before, pictures, mean);
}

TEST(JudgedResidue, FindsADelayAndAMemoryOfTheStages) {
  for (const JudgedPictures& late : {JudgedPictures{.delay = 1},
                                     {.delay = 3},
                                     {.memory = 0.5},
                                     {.memory = 0.8},
                                     {.memory = 0.95},
                                     {.delay = 1, .pulsation = 0.1}}) {
    const auto residue = judged_residue_of(late, 1);
    ASSERT_TRUE(residue) << late.delay << " " << late.memory;
    EXPECT_GT(residue->share, residue->limit) << late.delay << " " << late.memory;
    EXPECT_TRUE(residue->behind_stages);
  }
  // The mean of 16 pictures contains the late one.
  EXPECT_NEAR(judged_residue_of({.delay = 1}, 1)->share, 16.0 / 15, 0.01);
}

TEST(JudgedResidue, HasFewFalseAlarmsOfStagesWithoutMemory) {
  for (const JudgedPictures& right :
       {JudgedPictures{}, {.step = 60}, {.pulsation = 0.3}, {.noise_memory = 0.8}, {.noise_memory = 0.8, .step = 60}}) {
    int found = 0;
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
      const auto residue = judged_residue_of(right, seed);
      found += residue && residue->share > residue->limit ? 1 : 0;
    }
    EXPECT_LE(found, 5) << right.step << " " << right.pulsation << " " << right.noise_memory;
  }
}

std::vector<PresentedContrast> presented_of(double ratio, double error_of_one, double shared, std::uint64_t seed) {
  const RandomStream stream(seed, "presented");
  std::uint64_t draw = 0;
  std::vector<PresentedContrast> out;
  for (int set_up = 0; set_up < 8; ++set_up) {
    for (const double set_k : {16.9, 0.5}) {
      const double measured_error = error_of_one / 4;
      PresentedContrast one{.set_delta_t_k = set_k,
                            .measured = set_k + measured_error * stream.normal(draw++),
                            .measured_error = measured_error};
      const double pattern = std::sqrt(shared) * error_of_one * stream.normal(draw++);
      for (int k = 0; k < 12; ++k) {
        one.sum += ratio * set_k + pattern + std::sqrt(1 - shared) * error_of_one * stream.normal(draw++);
        one.errors += error_of_one, one.shared += shared;
        ++one.presentations;
      }
      out.push_back(one);
    }
  }
  return out;
}

TEST(PresentedChange, FindsATenthMoreAndHasFewFalseAlarms) {
  int found = 0, alarms = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    // At 0.5 K an amplitude has an error of 10 %, of which half recurs.
    const auto right = presented_change(presented_of(1, 0.05, 0.5, seed)).value();
    const auto wrong = presented_change(presented_of(1.1, 0.05, 0.5, seed)).value();
    alarms += right.beyond() ? 1 : 0;
    found += wrong.beyond() ? 1 : 0;
  }
  EXPECT_LE(alarms, 20);
  EXPECT_EQ(found, 2000);
}

TEST(PresentedChange, OfNothingPresentedIsNotKnown) {
  EXPECT_FALSE(presented_change({}));
  EXPECT_FALSE(presented_change(std::vector<PresentedContrast>{{.set_delta_t_k = 1, .measured = 1}}));
}

}  // namespace
}  // namespace todbench
