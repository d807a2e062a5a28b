// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tod/registration/plate_picture.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using todbench::testing::expected_scale;
using todbench::testing::PictureSpec;
using todbench::testing::plate_picture;
using todbench::testing::shipped_plate;
using todbench::testing::true_mapping;

RegistrationOptions planned() {
  RegistrationOptions options;
  options.expected_scale_px_per_mm = expected_scale;
  return options;
}

Registration registered(const TargetPlate& plate, const PictureSpec& spec) {
  return register_plate(plate_picture(plate, spec), plate, planned()).value();
}

TEST(PlateShift, IsMeasuredToAFewHundredthsOfAPixelAtTheLowestContrast) {
  // 0.23 K, 0.07 K noise, 16 frames averaged: contrast over noise 13. An edge blurred by 0.4 px carries information
  // like one of width w = 2 sqrt(pi) 0.4 px; a triangle has 2.28 S / w of it per axis. Four of 5.2 px and four of 3.6
  // px: sd = (1 / 13) / sqrt(2.28 * 35 / 1.42) = 0.010 px per axis, 0.015 px as a distance, a tenth more on the other
  // plate. The rms of 12 distances scatters by 14 %.
  for (const char* name : {"tcat-a", "tcat-b"}) {
    const TargetPlate plate = shipped_plate(name);
    PictureSpec spec;
    spec.noise_k = 0.07 / std::sqrt(32.0);
    const Registration before = registered(plate, spec);
    const cv::Point2d start = spec.centre_px;
    const RandomStream random(4, "test.shifts");
    double squares = 0;
    constexpr int repetitions = 12;
    for (std::uint64_t k = 0; k < repetitions; ++k) {
      const cv::Point2d moved(8 * random.uniform(2 * k) - 4, 8 * random.uniform(2 * k + 1) - 4);
      spec.centre_px = start + moved;
      spec.contrast_k = k % 2 == 0 ? 0.23 : -0.23;
      spec.noise_k = 0.07 / 4;
      spec.seed = 100 + k;

      const auto shift = measure_shift(plate_picture(plate, spec), plate, before, planned(), 5);

      ASSERT_TRUE(shift) << shift.error().message;
      squares += (*shift - moved).dot(*shift - moved) / repetitions;
    }

    EXPECT_LT(std::sqrt(squares), 0.026) << name;
  }
}

TEST(PlateShift, IsZeroForThePictureThatWasRegistered) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.noise_k = 0.07 / std::sqrt(32.0);
  const cv::Mat1d picture = plate_picture(plate, spec);
  const Registration found = register_plate(picture, plate, planned()).value();

  const auto shift = measure_shift(picture, plate, found, planned(), 3);

  // The joint fit weighs large triangles more than the registration does: they differ by a share of its residual.
  ASSERT_TRUE(shift) << shift.error().message;
  EXPECT_LT(cv::norm(*shift), 0.005);
}

TEST(PlateShift, IgnoresAGradientThatCameUpMeanwhile) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  const Registration before = registered(plate, spec);
  spec.contrast_k = 0.23;
  spec.gradient_k = {1, 0.5};
  spec.centre_px += {1.3, -0.6};

  const auto shift = measure_shift(plate_picture(plate, spec), plate, before, planned(), 3);

  ASSERT_TRUE(shift) << shift.error().message;
  EXPECT_LT(cv::norm(*shift - cv::Point2d(1.3, -0.6)), 0.01);  // no noise: aliasing only
}

TEST(PlateShift, IsRefusedWhenThePlateIsGoneOrDrownsInNoise) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  const Registration before = registered(plate, spec);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    cv::Mat1d noise(spec.size, 300.0);
    testing::add_noise(noise, 0.07, seed);

    const auto shift = measure_shift(noise, plate, before, planned(), 4);

    ASSERT_FALSE(shift);
    EXPECT_EQ(shift.error().code, ErrorCode::calibration);
    EXPECT_THAT(shift.error().message, HasSubstr("8 large triangles were not found within 4.0 px"));
  }
}

TEST(PlateShift, IsRefusedWhenTheMoveIsLargerThanTheSearch) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  const Registration before = registered(plate, spec);
  for (const double moved : {2.7, 4.5, 7.0}) {
    spec.centre_px = PictureSpec{}.centre_px + cv::Point2d(moved, 0);

    const auto shift = measure_shift(plate_picture(plate, spec), plate, before, planned(), 2);

    ASSERT_FALSE(shift) << moved << " px: " << *shift;
    EXPECT_EQ(shift.error().code, ErrorCode::calibration);
  }
}

TEST(PlateShift, IsRefusedForAThingThatIsNotThePlate) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  const Registration before = registered(plate, spec);
  cv::Mat1d picture(spec.size, 300.0);
  const cv::Point2d place = before.pixel(plate.triangles[0].position_mm);
  testing::add_triangle(picture, triangle(5.2, plate.triangles[0].apex, place), 10, 0.3);
  testing::add_noise(picture, 0.02, 9);

  const auto shift = measure_shift(picture, plate, before, planned(), 3);

  ASSERT_FALSE(shift);
  EXPECT_EQ(shift.error().code, ErrorCode::calibration);
}

}  // namespace
}  // namespace todbench
