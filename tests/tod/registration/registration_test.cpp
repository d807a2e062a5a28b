// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/tod/registration/plate_picture.h"
#include "tod/registration/blurred_polygon.h"
#include "tod/registration/plate_mapping.h"

namespace todbench {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using todbench::testing::add_triangle;
using todbench::testing::expected_scale;
using todbench::testing::mapped;
using todbench::testing::PictureSpec;
using todbench::testing::plate_picture;
using todbench::testing::shipped_plate;
using todbench::testing::true_mapping;

/// 0.07 K per frame, 32 frames averaged.
const double averaged_noise_k = 0.07 / std::sqrt(32.0);

RegistrationOptions planned_plate() {
  RegistrationOptions options;
  options.expected_scale_px_per_mm = expected_scale;
  return options;
}

/// Rms distance between the true and the registered places of all triangles, small ones included.
double place_error(const TargetPlate& plate, const Registration& found, const PictureSpec& spec) {
  const cv::Matx33d truth = true_mapping(spec);
  double sum = 0;
  for (const PlateTriangle& t : plate.triangles) {
    const cv::Point2d d = found.pixel(t.position_mm) - mapped(truth, t.position_mm);
    sum += d.dot(d) / static_cast<double>(plate.triangles.size());
  }
  return std::sqrt(sum);
}

std::string refusal(const Result<Registration>& result, ErrorCode code = ErrorCode::calibration) {
  if (result) return "registered";
  EXPECT_EQ(result.error().code, code) << result.error().message;
  return result.error().message;
}

TEST(BlurredPolygon, AgreesWithCountingPointsInABlurredTriangle) {
  // The second method: area coverage on cells of 0.1 px, blurred by a discrete Gaussian and a 0.9 px box of
  // variance 0.81 / 12 = 0.0675. For a Gaussian of 0.6 px the box is 16 % of the variance and its shape shows little.
  const Polygon outline = triangle(5.3, Apex::right, {11.3, 9.8});
  cv::Mat1d counted = cv::Mat1d::zeros(21, 24);
  add_triangle(counted, outline, 1, 0.6);

  const BlurredPolygon image = blurred_polygon(outline, std::sqrt(0.36 + 0.0675), {0, 0, 24, 21});

  // Counting errs by 0.01 px of edge position: 0.01 / (0.65 sqrt(2 pi)) = 0.006 in value; the box's shape adds less
  // than 0.002.
  EXPECT_LT(cv::norm(image.value - counted, cv::NORM_INF), 0.008);
  // Poisson sum: the sum over pixels is the area up to exp(-2 pi^2 0.43) = 2e-4 of it at most.
  EXPECT_NEAR(cv::sum(image.value)[0], 5.3 * 5.3, 0.006);
}

TEST(BlurredPolygon, DoesNotDependOnTheDirectionOfItsSlices) {
  // Slices along x of a polygon with exchanged axes are slices along y of the polygon: another quadrature of the same
  // integral. A side that lies nearly along the slices is the difficult case.
  const cv::Rect window(0, 0, 26, 26);
  for (const double turn : {0.0, 1e-9, 0.003, 0.1, 0.7, 3.2}) {
    Polygon outline, exchanged;
    for (const cv::Point2d& p : triangle(6.1, Apex::left, {0.3, -0.2})) {
      outline.emplace_back(12.6 + std::cos(turn) * p.x - std::sin(turn) * p.y,
                           12.9 + std::sin(turn) * p.x + std::cos(turn) * p.y);
      exchanged.emplace_back(outline.back().y, outline.back().x);
    }

    const BlurredPolygon image = blurred_polygon(outline, 0.5, window), other = blurred_polygon(exchanged, 0.5, window);

    EXPECT_LT(cv::norm(image.value - other.value.t(), cv::NORM_INF), 5e-6) << turn;
    EXPECT_LT(cv::norm(image.d_shift_x - other.d_shift_y.t(), cv::NORM_INF), 2e-5) << turn;
  }
}

TEST(BlurredPolygon, DerivativesAreThoseOfMovingIt) {
  const cv::Rect window(0, 0, 16, 15);
  const double h = 1e-3;
  const auto at = [&](double x, double y) {
    return blurred_polygon(triangle(4.2, Apex::down, {8.2 + x, 7.1 + y}), 0.45, window);
  };

  const BlurredPolygon image = at(0, 0);

  // Central difference: error h^2 / 6 times the third derivative (at most 2 / (0.45^3 sqrt(2 pi)) = 9): 1.5e-6; the
  // quadrature error of 5e-6 moves with the nodes and is divided by nothing larger than the blur.
  const cv::Mat1d by_x = (at(h, 0).value - at(-h, 0).value) / (2 * h);
  const cv::Mat1d by_y = (at(0, h).value - at(0, -h).value) / (2 * h);
  EXPECT_LT(cv::norm(image.d_shift_x - by_x, cv::NORM_INF), 2e-5);
  EXPECT_LT(cv::norm(image.d_shift_y - by_y, cv::NORM_INF), 2e-5);
}

TEST(PlateMapping, StaysASimilarityWithoutEvidenceAndFollowsATiltWithIt) {
  std::vector<cv::Point2d> plate, straight, aslant;
  const RandomStream noise(1, "test.places");
  const cv::Matx33d tilted(0.38, 0.01, 80, -0.01, 0.38, 70, 2e-4, -1e-4, 1);
  for (std::uint64_t i = 0; i < 8; ++i) {
    plate.emplace_back(-72 + 48.0 * static_cast<double>(i % 4), i < 4 ? -110.0 : 111.0);
    const cv::Point2d error(0.02 * noise.normal(2 * i), 0.02 * noise.normal(2 * i + 1));
    straight.push_back(0.38 * plate.back() + cv::Point2d(80, 70) + error);
    aslant.push_back(mapped(tilted, plate.back()) + error);
  }

  const FittedMapping plain = fit_mapping(plate, straight, {.expected_scale_px_per_mm = 0.38});
  const FittedMapping keystone = fit_mapping(plate, aslant, {.expected_scale_px_per_mm = 0.38});

  EXPECT_EQ(plain.mapping, PlateMapping::similarity);
  EXPECT_EQ(keystone.mapping, PlateMapping::homography);
  EXPECT_LT(keystone.residual_px, 0.06);  // 0.028 px rms in two dimensions is expected before fitting
}

TEST(Registration, PlacesAllTrianglesWithinAHundredthOfAPixelInEveryMountingAtHighAndMediumContrast) {
  // Fisher information at 0.0124 K on 5 K: (0.0124 / 5) / sqrt(2.28 S / 1.42) = 0.001 px per axis for S = 3.6 px.
  // Aliasing of 0.9 px boxes is exp(-2 pi^2 0.16) = 4 % of an edge at the sampling frequency, a few thousandths of a
  // pixel; both averaged over eight.
  for (const char* name : {"tcat-a", "tcat-b"}) {
    for (const Mounting mounting : all_mountings) {
      for (const double contrast : {16.9, 5.0, -5.0}) {
        const TargetPlate plate = mounted(shipped_plate(name), mounting);
        PictureSpec spec;
        spec.contrast_k = contrast;
        spec.noise_k = averaged_noise_k;
        spec.centre_px += {0.13 * contrast, 0.37};

        const auto found = register_plate(plate_picture(plate, spec), plate, planned_plate());

        ASSERT_TRUE(found) << found.error().message;
        EXPECT_LT(place_error(plate, *found, spec), 0.01) << name << " " << to_string(mounting) << " " << contrast;
        EXPECT_EQ(found->triangles_used, 8);
        EXPECT_EQ(found->contrast_sign, contrast > 0 ? 1 : -1);
        EXPECT_LT(std::abs(found->scale_deviation), 2e-4);  // 0.01 px over 50 px from the middle to the large rows
        EXPECT_LT(found->residual_px, 0.02);
      }
    }
  }
}

TEST(Registration, HoldsForARotatedPlateWithAGradientBehindItAndOtherThingsInThePicture) {
  const TargetPlate plate = shipped_plate("tcat-a");
  for (const double rotation : {-9.5, -3.0, 9.5}) {
    PictureSpec spec;
    spec.size = {220, 180};
    spec.centre_px = {118.3, 88.6};
    spec.rotation_deg = rotation;
    spec.noise_k = averaged_noise_k;
    spec.gradient_k = {4, -3};
    cv::Mat1d picture = plate_picture(plate, spec);
    // A lamp, a cold pipe end, and triangles of the wrong kind beside the plate.
    add_triangle(picture, {{8, 8}, {16, 8}, {16, 16}, {8, 16}}, 60, 0.3);
    add_triangle(picture, {{200, 150}, {206, 150}, {206, 170}, {200, 170}}, -30, 0.3);
    add_triangle(picture, triangle(4.6, Apex::down, {14, 90}), 16.9, 0.3);
    add_triangle(picture, triangle(4.6, Apex::up, {205, 30}), 16.9, 0.3);
    add_triangle(picture, triangle(3.6, Apex::left, {202, 112}), 16.9, 0.3);

    const auto found = register_plate(picture, plate, planned_plate());

    ASSERT_TRUE(found) << found.error().message;
    EXPECT_LT(place_error(plate, *found, spec), 0.01) << rotation;
    EXPECT_NEAR(found->rotation_deg, rotation, 0.01);  // 0.01 px at 50 px
  }
}

TEST(Registration, FindsTheBlurOfThePicture) {
  const TargetPlate plate = shipped_plate("tcat-a");
  for (const double gaussian : {0.3, 0.6}) {
    PictureSpec spec;
    spec.gaussian_px = gaussian;
    spec.noise_k = averaged_noise_k;

    const auto found = register_plate(plate_picture(plate, spec), plate, planned_plate());

    ASSERT_TRUE(found) << found.error().message;
    // Variances of Gaussian and box add; a least-squares Gaussian is within 5 % of it, plus 0.01 in its logarithm from
    // the search.
    const double expected = std::sqrt(gaussian * gaussian + 0.81 / 12);
    EXPECT_NEAR(found->blur_px, expected, 0.06 * expected);
  }
}

TEST(Registration, FollowsAPlateSeenAslant) {
  const TargetPlate plate = shipped_plate("tcat-b");
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;
  spec.tilt_per_mm = {8e-5, 4e-5};  // about 9 degrees at 2 m

  const auto found = register_plate(plate_picture(plate, spec), plate, planned_plate());

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->mapping, PlateMapping::homography);
  EXPECT_LT(place_error(plate, *found, spec), 0.02);
}

TEST(Registration, LeavesOutATriangleThatDoesNotShow) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;
  cv::Mat1d picture = plate_picture(plate, spec);
  const cv::Point2d covered = mapped(true_mapping(spec), plate.triangles[1].position_mm);
  const cv::Point corner(static_cast<int>(covered.x) - 8, static_cast<int>(covered.y) - 8);
  picture(cv::Rect(corner, cv::Size(17, 17))) = 300;

  const auto found = register_plate(picture, plate, planned_plate());

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->triangles_used, 7);
  EXPECT_LT(place_error(plate, *found, spec), 0.01);
}

TEST(Registration, LeavesOutATriangleThatABadPixelPullsAside) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;
  cv::Mat1d picture = plate_picture(plate, spec);
  // On a slanted edge of an inverted triangle: elsewhere the fit does not feel it. It pulls by about 25 K / (16.9 K
  // * 10.7) = 0.14 px.
  const cv::Point2d on_edge = mapped(true_mapping(spec), plate.triangles[2].position_mm) + cv::Point2d(2, 1);
  picture(static_cast<int>(std::lround(on_edge.y)), static_cast<int>(std::lround(on_edge.x))) += 25;

  const auto found = register_plate(picture, plate, planned_plate());

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->triangles_used, 7);
  EXPECT_LT(place_error(plate, *found, spec), 0.01);
}

TEST(Registration, LocatesAPlateOfOneTriangleWhenThatIsAllowed) {
  TargetPlate plate;
  plate.name = "one";
  plate.width_mm = plate.height_mm = 100;
  plate.triangles = {{"only", {3, -2}, 13.5, Apex::right}};
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;
  RegistrationOptions options = planned_plate();
  options.min_triangles = 1;

  const auto found = register_plate(plate_picture(plate, spec), plate, options);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->mapping, PlateMapping::translation);
  EXPECT_LT(place_error(plate, *found, spec), 0.01);
}

TEST(Registration, NamesTheMountingThatFitsWhenThePlateHangsOtherwise) {
  for (const char* name : {"tcat-a", "tcat-b"}) {
    const TargetPlate plate = shipped_plate(name);
    for (const Mounting stated : all_mountings) {
      if (stated == Mounting::rotated_180 || stated == Mounting::mirrored_vertically)
        continue;  // like the others, turned
      for (const Mounting real : all_mountings) {
        if (stated == real) continue;
        PictureSpec spec;
        spec.noise_k = averaged_noise_k;
        spec.contrast_k = 5;

        const auto found =
            register_plate(plate_picture(mounted(plate, real), spec), mounted(plate, stated), planned_plate());

        EXPECT_THAT(refusal(found), HasSubstr("seems to be mounted " + std::string(to_string(real)) + ", not " +
                                              std::string(to_string(stated))));
      }
    }
  }
}

TEST(Registration, RefusesAnotherPlate) {
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;

  const auto found =
      register_plate(plate_picture(shipped_plate("tcat-b"), spec), shipped_plate("tcat-a"), planned_plate());

  EXPECT_NE(refusal(found), "registered");
}

TEST(Registration, RefusesAPlateWhoseTrianglesPointElsewhere) {
  const TargetPlate plate = shipped_plate("tcat-a");
  TargetPlate other = plate;
  for (PlateTriangle& t : other.triangles) t.apex = static_cast<Apex>((static_cast<int>(t.apex) + 1) % 4);
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;

  const auto found = register_plate(plate_picture(other, spec), plate, planned_plate());

  EXPECT_THAT(refusal(found), HasSubstr("only 0 of 8 point as stated"));
}

TEST(Registration, ReportsBothScalesWhenTheyContradictEachOther) {
  for (const double factor : {0.4, 0.5, 0.6, 0.7, 0.8, 0.95, 1.05, 1.2, 1.4, 1.6, 2.2, 3.0, 3.9}) {
    const TargetPlate plate = shipped_plate("tcat-a");
    PictureSpec spec;
    spec.size = cv::Size(cv::Size2d(spec.size) * std::max(1.0, factor));
    spec.centre_px *= std::max(1.0, factor);
    spec.noise_k = averaged_noise_k;
    spec.scale = factor * expected_scale;

    const std::string message = refusal(register_plate(plate_picture(plate, spec), plate, planned_plate()));

    EXPECT_THAT(message, AllOf(HasSubstr("does not have the planned scale"), HasSubstr("give 0.3821 px/mm"))) << factor;
    ASSERT_THAT(message, AllOf(HasSubstr("shows "), HasSubstr("a deviation of ")));
    const auto number_after = [&](const std::string& words) {
      return std::stod(message.substr(message.find(words) + words.size()));
    };
    // Printed with four decimals of px/mm and one of per cent.
    EXPECT_NEAR(number_after("shows "), spec.scale, 1e-4) << message;
    EXPECT_NEAR(number_after("a deviation of "), 100 * (factor - 1), 0.11) << message;
  }
}

TEST(Registration, RefusesAPictureWhosePixelsAreNotSquareAndSaysBothScales) {
  for (const char* name : {"tcat-a", "tcat-b"}) {
    const TargetPlate plate = shipped_plate(name);
    for (const double stretch : {1 / 1.25, 1 / 1.15, 0.95, 1.05, 1.07, 1.1, 1.2, 1.25}) {
      PictureSpec spec;
      spec.size = {200, 200};
      spec.centre_px = {99.8, 98.7};
      spec.noise_k = averaged_noise_k;
      spec.stretch = stretch;

      const std::string said = refusal(register_plate(plate_picture(plate, spec), plate, planned_plate()));

      double along_x = 0, along_y = 0;
      const std::size_t stated = said.find("in the picture: ");
      ASSERT_NE(stated, std::string::npos) << name << ", " << stretch << ": " << said;
      ASSERT_EQ(std::sscanf(said.c_str() + stated, "in the picture: %lf px/mm along x and %lf", &along_x, &along_y), 2);
      EXPECT_NEAR(along_x / (expected_scale * std::sqrt(stretch)), 1, 0.004) << name << ", " << stretch;
      EXPECT_NEAR(along_y / (expected_scale / std::sqrt(stretch)), 1, 0.004) << name << ", " << stretch;
    }
  }
}

TEST(Registration, AllowsAStretchThatDoesNotChangeTheAcuity) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;
  spec.stretch = 1.03;

  const auto found = register_plate(plate_picture(plate, spec), plate, planned_plate());

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(place_error(plate, *found, spec), 0.02);
  EXPECT_NEAR(found->scale_deviation, 0, 0.001);
}

TEST(Registration, RefusesARotationBeyondItsLimitWithTheAngle) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;
  spec.rotation_deg = 14;

  const auto found = register_plate(plate_picture(plate, spec), plate, planned_plate());

  EXPECT_THAT(refusal(found), HasSubstr("is rotated by 14.0 degrees; at most 10.0 degrees are allowed"));
}

TEST(Registration, FindsNoPlateInAnEmptyPictureOrInNoise) {
  const TargetPlate plate = shipped_plate("tcat-a");
  cv::Mat1d flat(140, 160, 300.0);
  cv::Mat1d noise = flat.clone();
  testing::add_noise(noise, 0.07, 3);

  EXPECT_THAT(refusal(register_plate(flat, plate, planned_plate())),
              HasSubstr("not found: 0 of its 8 large triangles"));
  EXPECT_THAT(refusal(register_plate(noise, plate, planned_plate())), HasSubstr("not found"));
}

TEST(Registration, RefusesAPlateThatIsPartlyOutOfThePicture) {
  const TargetPlate plate = shipped_plate("tcat-a");
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;
  for (const cv::Point2d centre : {cv::Point2d(26, 70), cv::Point2d(135, 70)}) {
    spec.centre_px = centre;

    const std::string message = refusal(register_plate(plate_picture(plate, spec), plate, planned_plate()));

    EXPECT_THAT(message, AllOf(HasSubstr("is partly outside the picture of 160 x 140 pixels: 5 of 20 triangles"),
                               HasSubstr("would be at (")));
  }
}

TEST(Registration, RefusesWhenTooFewTrianglesShow) {
  const TargetPlate plate = shipped_plate("tcat-a");
  TargetPlate damaged = plate;
  damaged.triangles.erase(damaged.triangles.begin(), damaged.triangles.begin() + 3);
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;

  const auto found = register_plate(plate_picture(damaged, spec), plate, planned_plate());

  EXPECT_THAT(refusal(found), HasSubstr("too few usable triangles in the picture: 5 of 8 large ones were located, 6"));
}

TEST(Registration, RefusesAPlateThatIsNotMadeAsItsFileSays) {
  const TargetPlate plate = shipped_plate("tcat-a");
  TargetPlate bent = plate;
  for (std::size_t i = 0; i < bent.triangles.size(); ++i) bent.triangles[i].position_mm.x += i % 2 == 0 ? 1.7 : -1.7;
  PictureSpec spec;
  spec.noise_k = averaged_noise_k;

  const auto found = register_plate(plate_picture(bent, spec), plate, planned_plate());

  EXPECT_THAT(refusal(found), AllOf(HasSubstr("does not fit its file"), HasSubstr("0.250 px are allowed")));
}

TEST(Registration, RefusesOptionsUnderWhichNoPictureCouldBeRegistered) {
  const TargetPlate plate = shipped_plate("tcat-a");
  const cv::Mat1d picture(140, 160, 300.0);
  RegistrationOptions far = planned_plate();
  far.expected_scale_px_per_mm = expected_scale / 2;
  cv::Mat1d broken = picture.clone();
  broken(3, 4) = std::nan("");

  EXPECT_THAT(refusal(register_plate(picture, plate, {}), ErrorCode::invalid_input), HasSubstr("must be positive"));
  EXPECT_THAT(refusal(register_plate(picture, plate, far), ErrorCode::invalid_input),
              HasSubstr("only 4 of its 20 triangles are at least 2.5 px"));
  EXPECT_THAT(refusal(register_plate(broken, plate, planned_plate()), ErrorCode::invalid_input),
              HasSubstr("not finite"));
}

TEST(Registration, MovesWithThePlateAndWithThePicture) {
  Registration r;
  r.plate_to_pixel = true_mapping({.rotation_deg = 30, .tilt_per_mm = {1e-4, 0}});
  const cv::Point2d place(31, -12);

  // Composition of 3 x 3 matrices with entries near 100: rounding of 1e-13.
  EXPECT_LT(cv::norm(r.shifted({2, -3}).pixel(place) - r.pixel(place + cv::Point2d(2, -3))), 1e-12);
  EXPECT_LT(cv::norm(r.moved({2, -3}).pixel(place) - r.pixel(place) - cv::Point2d(2, -3)), 1e-12);
  // Area magnification by the image of a small square.
  const double h = 1e-3;
  const cv::Point2d along = r.pixel(place + cv::Point2d(h, 0)) - r.pixel(place - cv::Point2d(h, 0));
  const cv::Point2d across = r.pixel(place + cv::Point2d(0, h)) - r.pixel(place - cv::Point2d(0, h));
  EXPECT_NEAR(r.scale_at(place), std::sqrt(along.cross(across)) / (2 * h), 1e-8);
}

}  // namespace
}  // namespace todbench
