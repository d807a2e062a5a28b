// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/super_resolution.h"

#include <gmock/gmock.h>

#include <cmath>

#include "acquisition/base/rng.h"
#include "sim_devices/sensor/image_chain.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr int side = 48;

/// Frames of one degraded triangle whose content is displaced by the shifts, at `per_pixel` samples per pixel.
cv::Mat1f exposure(cv::Point2d shift, double size_pitch = 6, double step = 1, cv::Point2d first = {0, 0}) {
  static const SensorSpec spec = test::sc2000();
  static const ImageChain chain(spec, full_plan(spec, {}, {}), Accuracy::normal());
  const PolygonImage image = chain.image(triangle(size_pitch, Apex::right));
  const int samples = static_cast<int>(side / step);
  const int period = image.lattice().period;
  cv::Mat1f out(samples, samples);
  out = 0.0F;
  const int count = std::min(samples, static_cast<int>(period / step));
  const int begin = (samples - count) / 2;
  const cv::Point2d centre(side / 2.0 + 0.3, side / 2.0 - 0.2);
  const cv::Mat1d values =
      image.sample(first + cv::Point2d(begin * step, begin * step) - centre - shift, step, {count, count});
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) out(begin + j, begin + i) = static_cast<float>(values(j, i));
  }
  return out;
}

cv::Mat1f noise(std::uint64_t index, double sd) {
  cv::Mat1f out(side, side);
  RandomStream(1, "super_resolution_test").sub(index).fill_normal(std::span(out.ptr<float>(), out.total()));
  return out * sd;
}

const std::vector<cv::Point2d> quarters{{0, 0}, {-0.5, 0}, {0, -0.5}, {-0.5, -0.5}};

TEST(SuperResolution, FourFramesHalfAPixelApartEqualTheFinelySampledPicture) {
  std::vector<cv::Mat1f> frames;
  for (const auto& shift : quarters) frames.push_back(exposure(shift));

  const auto result = super_resolve(frames, quarters);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_EQ(result->picture.size(), cv::Size(2 * side, 2 * side));
  EXPECT_NEAR(result->placement_rms_px, 0, 1e-12);
  const cv::Mat1f fine = exposure({0, 0}, 6, 0.5, result->first_px);
  // The same exact picture, sampled once in four parts and once as a whole: single precision.
  EXPECT_LT(cv::norm(result->picture(cv::Rect(8, 8, 80, 80)), fine(cv::Rect(8, 8, 80, 80)), cv::NORM_INF), 1e-6);
}

TEST(SuperResolution, OneFrameIsInterpolatedBetweenItsPixelsOnRequest) {
  cv::Mat1f ramp(16, 16);
  for (int row = 0; row < 16; ++row) {
    for (int column = 0; column < 16; ++column) ramp(row, column) = static_cast<float>(3 * column - 2 * row);
  }

  const auto result = super_resolve({ramp}, {{0, 0}}, 2, EmptyCells::interpolated);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(super_resolve({ramp}, {{0, 0}}, 2).has_value());
  // A plane is shown as a plane, also where only the mean of two or four pixels is known.
  for (int row = 1; row < 30; ++row) {
    for (int column = 1; column < 30; ++column) {
      const cv::Point2d px = result->first_px + cv::Point2d(column, row) / 2;
      EXPECT_NEAR(result->picture(row, column), 3 * px.x - 2 * px.y, 1e-5) << row << " " << column;
    }
  }
}

TEST(SuperResolution, OneFrameAtFactorOneIsThatFrame) {
  const cv::Mat1f frame = exposure({0, 0}) + noise(0, 0.1);

  const auto result = super_resolve({frame}, {{0, 0}}, 1);

  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(cv::norm(result->picture, frame, cv::NORM_INF), 0);
}

TEST(SuperResolution, NoiseFallsWithTheSquareRootOfTheFramesInACell) {
  std::vector<cv::Mat1f> frames;
  std::vector<cv::Point2d> shifts;
  for (std::uint64_t k = 0; k < 16; ++k) {
    frames.push_back(noise(k, 1));
    shifts.push_back(quarters[k % 4]);
  }

  const auto result = super_resolve(frames, shifts);

  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(cv::countNonZero(result->frames_per_cell == 4), 4);
  cv::Scalar mean, sd;
  cv::meanStdDev(result->picture(cv::Rect(4, 4, 2 * side - 8, 2 * side - 8)), mean, sd);
  // 88^2 independent samples: the sd is known to 1 / sqrt(2 * 7744) = 0.8 %.
  EXPECT_NEAR(sd[0], 0.5, 4 * 0.008 * 0.5);
}

TEST(SuperResolution, RegistrationFindsKnownShifts) {
  const cv::Mat1f reference = exposure({0, 0});
  for (const cv::Point2d shift : {cv::Point2d(0.37, -0.81), cv::Point2d(3.2, 2.6), cv::Point2d(-0.5, 0.5)}) {
    const auto found = frame_shift(reference, exposure(shift));

    ASSERT_TRUE(found.has_value()) << found.error().message;
    // An edge along the columns is aliased all in one phase: frequency 0.85 appears at 0.15 with 1/6 of the amplitude
    // that is there by the edge's spectrum (1/f) and a quarter of that by the sensor's transfer: 4 % of the energy that
    // fixes x, which for half a pixel is 0.03 px. Slanted edges average it out.
    EXPECT_NEAR(found->x, shift.x, 0.04);
    EXPECT_NEAR(found->y, shift.y, 0.02);
  }
}

TEST(SuperResolution, RegistrationInNoiseIsAsPreciseAsTheEdgesAllow) {
  const cv::Point2d shift(0.4, -0.3);
  double squares = 0;
  const int runs = 20;
  for (std::uint64_t k = 0; k < runs; ++k) {
    const auto found =
        frame_shift(exposure({0, 0}) + noise(2 * k, 0.02) + 300.0, exposure(shift) + noise(2 * k + 1, 0.02) + 301.0);
    ASSERT_TRUE(found.has_value());
    squares += (found->x - shift.x) * (found->x - shift.x) + (found->y - shift.y) * (found->y - shift.y);
  }
  // Two axes; gradient energy of a triangle of size 6: perimeter 13.7, blurred to sigma 1.1, gives about 13.7 / 2 /
  // (2 sqrt(pi) 1.1) = 1.75 per axis; noise 0.02 sqrt(2), blurred: 0.028 * 0.28 per independent blur cell, times the
  // correlation of the cells (a factor near 3.5): 0.028 / sqrt(1.75) = 0.021 per axis.
  EXPECT_LT(std::sqrt(squares / runs / 2), 0.04);
}

TEST(SuperResolution, RegisteredFramesAreAveragedWithoutBeingTold) {
  std::vector<cv::Mat1f> frames;
  for (const auto& shift : quarters) frames.push_back(exposure(shift, 8));

  const auto registered = super_resolve(frames);
  const auto told = super_resolve(frames, quarters);

  ASSERT_TRUE(registered.has_value()) << registered.error().message;
  ASSERT_TRUE(told.has_value());
  EXPECT_LT(cv::norm(registered->picture, told->picture, cv::NORM_INF), 1e-6);
  EXPECT_NEAR(registered->first_px.x, told->first_px.x, 0.04);
}

TEST(SuperResolution, RefusesWhatItCannotDo) {
  const cv::Mat1f frame = exposure({0, 0});

  EXPECT_FALSE(super_resolve({}, {}).has_value());
  EXPECT_FALSE(super_resolve({frame, frame}, {{0, 0}}).has_value());
  const auto gaps = super_resolve({frame, frame}, {{0, 0}, {0.5, 0}});
  ASSERT_FALSE(gaps.has_value());
  EXPECT_THAT(gaps.error().message, testing::HasSubstr("2 of the 4 cells"));
  EXPECT_FALSE(super_resolve({frame, cv::Mat1f(8, 8)}, {{0, 0}, {0.5, 0.5}}).has_value());
  EXPECT_FALSE(frame_shift(cv::Mat1f::zeros(side, side), cv::Mat1f::zeros(side, side)).has_value());
}

}  // namespace
}  // namespace todbench
