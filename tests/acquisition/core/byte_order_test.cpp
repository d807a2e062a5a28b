// SPDX-License-Identifier: GPL-3.0-or-later
// The detector of swapped bytes, its error rate on simulated and real pictures.
#include "acquisition/core/byte_order.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/base/rng.h"
#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/raw_recording.h"
#include "tests/support/source_file.h"
#include "tests/support/swapped_bytes.h"

namespace todbench {
namespace {

/// What the detector says of many pictures in the right order and of the same with swapped bytes.
struct Tally {
  int pictures = 0, wrong = 0, undecided = 0;
  double weakest = 1e9;  ///< smallest |log_ratio|
  void add(const cv::Mat1w& counts) {
    const ByteOrderEvidence right = byte_order_evidence(counts, {});
    const ByteOrderEvidence other = byte_order_evidence(with_swapped_bytes(counts), {});
    for (const auto& [verdict, truth] :
         {std::pair(right.verdict, ByteOrderVerdict::as_stated), std::pair(other.verdict, ByteOrderVerdict::swapped)}) {
      ++pictures;
      undecided += verdict == ByteOrderVerdict::undecided ? 1 : 0;
      wrong += verdict != ByteOrderVerdict::undecided && verdict != truth ? 1 : 0;
    }
    weakest = std::min({weakest, std::abs(right.log_ratio), std::abs(other.log_ratio)});
  }
};

/// A thermal picture: a level, a gradient, a few warm blobs with sharp edges, column noise, temporal noise.
cv::Mat1w thermal_picture(int significant_bits, double noise_counts, std::uint64_t seed) {
  const RandomStream random(seed, "scene");
  const double full_scale = (1 << significant_bits) - 1;
  const int width = 160, height = 120;
  const double level = full_scale * (0.2 + 0.6 * random.uniform(0));
  const double contrast = full_scale * 0.15 * random.uniform(1);
  const double slope = full_scale * 0.05 * (random.uniform(2) - 0.5) / width;
  cv::Mat1d picture(height, width);
  std::uint64_t index = 1000;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double value = level + slope * x;
      for (std::uint64_t blob = 0; blob < 5; ++blob) {
        const double dx = x - width * random.uniform(10 + 4 * blob), dy = y - height * random.uniform(11 + 4 * blob);
        value += std::hypot(dx, dy) < 4 + 20 * random.uniform(12 + 4 * blob) ? contrast : 0;
      }
      value += noise_counts * (random.normal(index++) + 0.5 * random.normal(1'000'000 + static_cast<unsigned>(x)));
      picture(y, x) = std::clamp(std::round(value), 0.0, full_scale);
    }
  }
  return picture;
}

Tally simulated(int significant_bits, double noise_counts, int scenes) {
  Tally tally;
  for (int seed = 0; seed < scenes; ++seed) {
    tally.add(thermal_picture(significant_bits, noise_counts, static_cast<std::uint64_t>(seed)));
  }
  return tally;
}

Tally recorded(Result<Recording> recording) {
  Tally tally;
  EXPECT_TRUE(recording.has_value());
  for (std::uint64_t i = 0; recording && i < recording->frame_count; ++i) tally.add(recording->read(i)->counts);
  return tally;
}

const std::string golden = source_file("tests/golden/real/");

// No error in n pictures bounds the error rate by 3 / n with 95 % confidence.
TEST(ByteOrder, IsRightOnEveryPictureOfASimulatedCameraOfUsualNoise) {
  for (const int bits : {12, 14, 16}) {
    for (const double noise : {0.5, 2.0, 8.0, 32.0}) {
      const Tally tally = simulated(bits, noise, 40);

      EXPECT_EQ(tally.wrong, 0) << bits << " bits, " << noise << " counts";
      EXPECT_EQ(tally.undecided, 0) << bits << " bits, " << noise << " counts, weakest " << tally.weakest;
    }
  }
}

TEST(ByteOrder, IsNeverWrongHoweverStrongTheNoise) {
  for (const double noise : {100.0, 1000.0, 4000.0, 20000.0}) EXPECT_EQ(simulated(16, noise, 25).wrong, 0) << noise;
}

TEST(ByteOrder, IsRightOnEveryFrameOfRealCameras) {
  const Tally lepton_a = recorded(open_raw_recording(golden + "lepton_a_160x120_u16le.raw", {160, 120, 14}));
  const Tally lepton_b = recorded(open_raw_recording(golden + "lepton_b_160x120_u16le.raw", {160, 120, 14}));
  const Tally sc660 = recorded(open_flir_seq(golden + "flir_sc660.seq"));

  EXPECT_EQ(lepton_a.pictures + lepton_b.pictures + sc660.pictures, 2 * (100 + 102 + 2));
  for (const Tally* tally : {&lepton_a, &lepton_b, &sc660}) {
    EXPECT_EQ(tally->wrong, 0);
    EXPECT_EQ(tally->undecided, 0);
    // e^2: neighbours differ at least seven times less in the right order.
    EXPECT_GT(tally->weakest, 2);
  }
}

TEST(ByteOrder, OfNoiseHasTheRatioOfItsClosedForm) {
  // Neighbours of white noise with standard deviation s differ by 2 s / sqrt(pi) on average. Swapped, their low bytes
  // are the high ones: two independent uniform bytes differ by 256 / 3 (1 - 1 / 256^2), times 256. Half a percent is
  // five standard errors for 320 x 240 pixels.
  const double sigma = 200;
  const RandomStream random(3, "noise");
  cv::Mat1w picture(240, 320);
  std::uint64_t index = 0;
  for (auto& pixel : picture) pixel = static_cast<std::uint16_t>(std::lround(30000 + sigma * random.normal(index++)));

  const ByteOrderEvidence evidence = byte_order_evidence(picture, {});

  const double expected = std::log(2 * sigma / std::sqrt(std::numbers::pi)) - std::log(256.0 * 256 / 3);
  EXPECT_NEAR(evidence.log_ratio, expected, 0.01);
  EXPECT_NEAR(byte_order_evidence(with_swapped_bytes(picture), {}).log_ratio, -evidence.log_ratio, 1e-12);
}

TEST(ByteOrder, OfAPictureThatTellsNothingIsUndecided) {
  cv::Mat1w eight_bits_up(20, 20), eight_bits(20, 20);
  for (int i = 0; i < 400; ++i) {
    eight_bits(i / 20, i % 20) = static_cast<std::uint16_t>(100 + i % 7);
    eight_bits_up(i / 20, i % 20) = static_cast<std::uint16_t>((100 + i % 7) << 8);
  }

  EXPECT_EQ(byte_order_evidence(cv::Mat1w(20, 20, std::uint16_t{7000}), {}).verdict, ByteOrderVerdict::undecided);
  EXPECT_EQ(byte_order_evidence(eight_bits, {}).verdict, ByteOrderVerdict::undecided);
  EXPECT_EQ(byte_order_evidence(eight_bits_up, {}).verdict, ByteOrderVerdict::undecided);
  EXPECT_EQ(byte_order_evidence(cv::Mat1w(), {}).verdict, ByteOrderVerdict::undecided);
}

TEST(ByteOrderWatch, IsDecidedByOneFrameAndAsksOnlyOfCountsOfTwoBytes) {
  const cv::Mat1w low = (cv::Mat1w(2, 3) << 90, 95, 100, 92, 97, 93);
  ByteOrderWatch watch;
  EXPECT_EQ(watch.verdict(), ByteOrderVerdict::as_stated);
  watch.see(low, 8);
  EXPECT_EQ(watch.note(), "");
  watch.see(low, 14);
  EXPECT_EQ(watch.verdict(), ByteOrderVerdict::undecided);
  EXPECT_THAT(watch.note(), ::testing::HasSubstr("the high byte of every count is zero"));
  watch.see(thermal_picture(14, 4, 1), 14);
  EXPECT_EQ(watch.verdict(), ByteOrderVerdict::as_stated);
  EXPECT_EQ(watch.note(), "");
}

}  // namespace
}  // namespace todbench
