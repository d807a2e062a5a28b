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
using todbench::testing::mapped;
using todbench::testing::PictureSpec;
using todbench::testing::plate_picture;
using todbench::testing::shipped_plate;
using todbench::testing::true_mapping;

/// The registration that a perfect one would find.
Registration perfect(const PictureSpec& spec) {
  Registration r;
  r.plate_to_pixel = true_mapping(spec);
  r.scale_px_per_mm = spec.scale;
  return r;
}

/// One triangle per orientation of `size_px`, far apart.
TargetPlate plate_of_size(double size_px) {
  TargetPlate plate;
  plate.name = "test";
  plate.width_mm = plate.height_mm = 200;
  for (const Apex apex : all_apexes) {
    const double index = static_cast<double>(apex);
    plate.triangles.push_back(
        {std::string(to_string(apex)), {-72 + 48 * index, index * 7}, size_px / expected_scale, apex});
  }
  return plate;
}

// Its sums hold the light that blur takes out of a triangle: they lose what lies beyond 2 px.
TEST(ContrastOfSmallTriangles, DoesNotDependOnSizeAndSamplingPhase) {
  for (const double size_px : {2.1, 3.0, 3.9}) {
    const TargetPlate plate = plate_of_size(size_px);
    for (int phase = 0; phase < 25; ++phase) {
      PictureSpec spec;
      spec.centre_px += {0.2 * (phase % 5), 0.2 * (phase / 5)};
      const cv::Mat1d picture = plate_picture(plate, spec);

      const auto contrast = contrast_of_small_triangles(picture, plate, perfect(spec), 4);

      ASSERT_TRUE(contrast) << size_px;
      EXPECT_NEAR(*contrast / 16.9, 1, 0.01) << size_px << " " << phase;
      EXPECT_FALSE(contrast_of_small_triangles(picture, plate, perfect(spec), 2));
    }
  }
}

TEST(EffectiveContrast, LosesToBlurWhatItsHeaderSays) {
  // Mean over 5 x 5 sampling phases and four orientations, total blur sqrt(0.3^2 + 0.9^2 / 12) = 0.40 px. The bounds
  // are the documented figures; the measured value can only be too small, except for 1e-3 from the grid of the test
  // picture.
  const struct { double size_px, most_loss; } cases[] = {{4, 0.005}, {5, 0.001}, {6, 0.0005}, {8, 0.0005}};
  for (const auto& [size_px, most_loss] : cases) {
    const TargetPlate plate = plate_of_size(size_px);
    double mean = 0;
    for (int phase = 0; phase < 25; ++phase) {
      PictureSpec spec;
      spec.centre_px += {0.2 * (phase % 5), 0.2 * (phase / 5)};
      mean += effective_contrast(plate_picture(plate, spec), plate, perfect(spec), 3.9).value().value / 25;
    }
    const double loss = 1 - mean / 16.9;

    EXPECT_LT(loss, most_loss) << size_px;
    EXPECT_GT(loss, -1e-6) << size_px;
  }
}

TEST(EffectiveContrast, HasAStandardErrorThatMatchesItsScatterInNoise) {
  // 24 independent pictures: the ratio of scatter to mean stated error has a relative sd of about 1 / sqrt(2 * 23) = 15
  // % from the scatter, and the error over four triangles is 8 % low on average (c4 of 3 degrees of freedom): accepted
  // are 1.08 +- 4 * 0.16.
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.contrast_k = 0.23;
  const cv::Mat1d clean = plate_picture(plate, spec);
  const double without_noise = effective_contrast(clean, plate, perfect(spec), 4).value().value;
  double mean_error = 0, squares = 0;
  constexpr int repetitions = 24;
  for (std::uint64_t k = 0; k < repetitions; ++k) {
    cv::Mat1d picture = clean.clone();
    testing::add_noise(picture, 0.07 / 4, k);

    const EffectiveContrast c = effective_contrast(picture, plate, perfect(spec), 4).value();

    EXPECT_EQ(c.triangles, 4);
    mean_error += c.standard_error / repetitions;
    squares += (c.value - without_noise) * (c.value - without_noise) / repetitions;
  }
  EXPECT_GT(std::sqrt(squares) / mean_error, 0.44);
  EXPECT_LT(std::sqrt(squares) / mean_error, 1.72);
  EXPECT_LT(mean_error, 0.01);  // 0.0175 K / sqrt(8 pixels) * 1.25, over four triangles: 0.004 K
}

TEST(EffectiveContrast, KeepsItsSign) {
  const TargetPlate plate = shipped_plate("tcat-b");
  PictureSpec spec;
  spec.contrast_k = -5;

  const EffectiveContrast c = effective_contrast(plate_picture(plate, spec), plate, perfect(spec), 4).value();

  EXPECT_NEAR(c.value, -5, 0.1);
}

TEST(EffectiveContrast, DoesNotCareForAGradientOrABadPixel) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.contrast_k = 5;
  const double plain = effective_contrast(plate_picture(plate, spec), plate, perfect(spec), 5).value().value;
  spec.gradient_k = {3, 3};
  cv::Mat1d picture = plate_picture(plate, spec);
  const cv::Point2d inside = mapped(true_mapping(spec), plate.triangles[0].position_mm);
  picture(static_cast<int>(std::lround(inside.y)), static_cast<int>(std::lround(inside.x))) += 500;

  const double disturbed = effective_contrast(picture, plate, perfect(spec), 5).value().value;

  // 3 K over 160 px is 0.02 K per pixel: a median that moves by one rank of eight pixels moves by less than a pixel of
  // it.
  EXPECT_NEAR(disturbed, plain, 0.04);
}

TEST(EffectiveContrast, OfOneTriangleTakesItsErrorFromItsPixels) {
  TargetPlate plate = shipped_plate("tcat-a");
  plate.triangles.resize(1);
  PictureSpec spec;
  spec.noise_k = 0.02;

  const EffectiveContrast c = effective_contrast(plate_picture(plate, spec), plate, perfect(spec), 4).value();

  // 1.25 * 0.02 K / sqrt(5 to 12 pixels inside), the noise itself estimated from some hundred pixels of the ring.
  EXPECT_EQ(c.triangles, 1);
  EXPECT_GT(c.standard_error, 0.005);
  EXPECT_LT(c.standard_error, 0.014);
}

TEST(EffectiveContrast, IsRefusedWithoutALargeEnoughTriangle) {
  const TargetPlate plate = shipped_plate("tcat-a");
  const PictureSpec spec;

  const auto result = effective_contrast(plate_picture(plate, spec), plate, perfect(spec), 6);

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(result.error().message, HasSubstr("no triangle is at least 6.0 px, the largest is 5.2 px"));
}

TEST(EffectiveContrast, IsRefusedWhereTheReferenceTriangleLeavesThePicture) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.centre_px.x = 20;

  const auto result = effective_contrast(plate_picture(plate, spec), plate, perfect(spec), 4);

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::calibration);
}

}  // namespace
}  // namespace todbench
