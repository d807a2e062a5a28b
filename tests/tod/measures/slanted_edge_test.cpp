// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/slanted_edge.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/tod/measures/edge_picture.h"
#include "tests/tod/measures/measures_reference.h"

namespace todbench {
namespace {

using test::EdgePicture;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string refused(const cv::Mat1d& picture, const SlantedEdgeOptions& options = {}) {
  const auto found = slanted_edge(picture, options);
  EXPECT_FALSE(found);
  return found ? "" : found.error().message;
}

/// Largest difference from the truth up to a frequency.
double error_of(const SlantedEdge& edge, const EdgePicture& made, double up_to) {
  double worst = 0;
  for (std::size_t i = 0; i < edge.mtf.size() && edge.frequency_per_pitch[i] <= up_to + 1e-9; ++i)
    worst = std::max(worst, std::abs(edge.mtf[i] - made.mtf(edge.frequency_per_pitch[i])));
  return worst;
}

EdgePicture picture_of(const nlohmann::json& reference) {
  return {reference["blur_sigma_pitch"],     reference["detector_pitch"], reference["angle_degrees"],
          reference["edge_x_at_middle_row"], reference["rows"],           reference["columns"]};
}

TEST(EdgePicture, HasThePixelsAndTheMtfOfTheReference) {
  for (const auto& reference : test::reference_cases("edge", "edges")) {
    const EdgePicture made = picture_of(reference);
    const cv::Mat1d picture = made.picture();
    const auto& pixels = reference["pixels_rows_0_39_79_columns_17_to_23"];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 7; ++c)
        EXPECT_NEAR(picture(r == 0 ? 0 : r == 1 ? 39 : 79, 17 + static_cast<int>(c)), pixels[r][c], 1e-9);
    }
    const auto& frequencies = reference["frequency_cycles_per_pitch_along_normal"];
    for (std::size_t k = 0; k < frequencies.size(); ++k)
      EXPECT_NEAR(made.mtf(frequencies[k]), reference["mtf_true"][k], 1e-9);
  }
}

TEST(SlantedEdge, FindsTheMtfOfTheReferenceWithinAThousandth) {
  for (const auto& reference : test::reference_cases("edge", "edges")) {
    const EdgePicture made = picture_of(reference);

    const auto edge = slanted_edge(made.picture(), {}).value();

    EXPECT_LT(error_of(edge, made, 0.5), 0.001);
    EXPECT_NEAR(edge.angle_deg, made.angle_deg, 0.005);
    EXPECT_NEAR(edge.mtf50_per_pitch.value(), reference["mtf50"], 0.001);
    EXPECT_EQ(edge.axis, EdgeAxis::x);
    EXPECT_NEAR(edge.step, 1, 1e-6);
  }
}

// The method's own error, which is in every interval: 30 blurs and 3 angles without noise.
TEST(SlantedEdge, ErrsByLessThanItSaysOverThirtyBlursAndThreeAngles) {
  for (const double angle : {3.0, 5.0, 8.0}) {
    for (int blur = 0; blur < 30; ++blur) {
      const EdgePicture made{0.1 + 0.08 * blur, 0.895, angle, 20.2 + 0.03 * blur, 80, 41};

      const auto edge = slanted_edge(made.picture(), {}).value();

      EXPECT_LT(error_of(edge, made, 0.5), 0.0003) << angle << " degrees, blur " << made.blur_sigma_pitch;
      EXPECT_LT(error_of(edge, made, 1), 0.0023) << angle << " degrees, blur " << made.blur_sigma_pitch;
      for (std::size_t i = 0; i < edge.mtf.size(); ++i) {
        const double truth = made.mtf(edge.frequency_per_pitch[i]);
        EXPECT_TRUE(edge.mtf_low[i] <= truth + 1e-12 && truth <= edge.mtf_high[i] + 1e-12)
            << angle << " degrees, blur " << made.blur_sigma_pitch << ", " << edge.frequency_per_pitch[i];
      }
    }
  }
}

// Normals between the axes, as those of a slanted star; near 45 degrees the lines repeat most slowly.
TEST(SlantedEdge, FindsTheMtfAlongAnyDirectionUpToTheDiagonal) {
  for (const double angle : {5.0, 20.0, 30.0, 44.0, 45.5, -30.0, -44.0}) {
    const double span = 80 * std::tan(std::abs(angle) * std::numbers::pi / 180);
    for (const double blur : {0.3, 0.6}) {
      const EdgePicture made{blur, 0.895, angle, std::floor(span / 2) + 22.2, 80, static_cast<int>(span) + 44};
      int inside = 0;

      const auto edge = slanted_edge(made.picture(), {.axis = EdgeAxis::x}).value();
      for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const auto noisy = slanted_edge(made.noisy(0.005, seed), {.axis = EdgeAxis::x}).value();
        inside += noisy.mtf_low[25] <= made.mtf(0.25) && made.mtf(0.25) <= noisy.mtf_high[25] ? 1 : 0;
      }

      EXPECT_NEAR(edge.angle_deg, angle, 1e-3);
      EXPECT_LT(error_of(edge, made, 0.5), 0.0003) << angle << " degrees, blur " << blur;
      // Five or fewer of eight has a probability of 0.6 % at 95 %.
      EXPECT_GE(inside, 6) << angle << " degrees, blur " << blur;
    }
  }
}

TEST(SlantedEdge, HasTheTruthInItsIntervalsInNineteenOfTwentyNoisyPictures) {
  const EdgePicture made;
  constexpr int seeds = 60;
  for (const double noise : {0.002, 0.02}) {
    std::map<int, int> inside;

    for (int seed = 1; seed <= seeds; ++seed) {
      const auto edge = slanted_edge(made.noisy(noise, static_cast<std::uint64_t>(seed)), {}).value();
      for (const int k : {5, 10, 25, 50}) {
        const double truth = made.mtf(k / 100.0);
        const auto i = static_cast<std::size_t>(k);
        if (edge.mtf_low[i] <= truth && truth <= edge.mtf_high[i]) ++inside[k];
      }
    }

    // 95 % less four standard errors of a proportion from 60 seeds.
    for (const auto& [k, count] : inside) EXPECT_GE(count, 0.837 * seeds) << k << " % of a cycle, noise " << noise;
  }
}

TEST(SlantedEdge, IsTheSameForEitherPolarityAndAlongEitherAxis) {
  const EdgePicture made;
  const cv::Mat1d picture = made.picture();
  const auto plain = slanted_edge(picture, {}).value();

  const auto inverted = slanted_edge(5000 - 300 * picture, {}).value();
  const auto turned = slanted_edge(picture.t(), {}).value();

  EXPECT_EQ(turned.axis, EdgeAxis::y);
  EXPECT_NEAR(inverted.step, 300, 1e-3);
  for (std::size_t i = 0; i < plain.mtf.size(); ++i) {
    EXPECT_NEAR(inverted.mtf[i], plain.mtf[i], 1e-6);
    EXPECT_EQ(turned.mtf[i], plain.mtf[i]);
  }
  EXPECT_NEAR(inverted.angle_deg, plain.angle_deg, 1e-6);
}

TEST(SlantedEdge, TakesShadingOutAndSaysSo) {
  const EdgePicture made;
  cv::Mat1d picture = made.picture();
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) picture(y, x) += 0.002 * x + 0.001 * y;
  }

  const auto edge = slanted_edge(picture, {}).value();

  EXPECT_LT(error_of(edge, made, 0.5), 0.001);
  EXPECT_GT(edge.shading_percent, 5);
  EXPECT_THAT(edge.notes, ElementsAre(HasSubstr("uneven"), HasSubstr("wider than")));
}

TEST(SlantedEdge, RefusesAnEdgeThatIsOutOfRange) {
  const auto with = [](auto change) {
    EdgePicture made;
    change(made);
    return made.picture();
  };
  EXPECT_THAT(refused(with([](EdgePicture& e) { e.angle_deg = 0.5; })), HasSubstr("less than one pixel"));
  EXPECT_THAT(refused(with([](EdgePicture& e) { e = {0.3, 0.895, 50, 40, 20, 80}; }), {.axis = EdgeAxis::x}),
              HasSubstr("at most 46"));
  EXPECT_THAT(refused(with([](EdgePicture& e) { e = {0.3, 0.895, 45, 61.2, 80, 122}; }), {.axis = EdgeAxis::x}),
              HasSubstr("gaps"));
  EXPECT_THAT(refused(with([](EdgePicture& e) { e.angle_deg = 18.434948822922; })), HasSubstr("gaps"));
  EXPECT_THAT(refused(with([](EdgePicture& e) { e.edge_at_pitch = 6; })), HasSubstr("border"));
  EXPECT_THAT(refused(with([](EdgePicture& e) { e.angle_deg = 20, e.rows = 200; })), HasSubstr("leaves the picture"));
  EXPECT_THAT(refused(with([](EdgePicture& e) { e.blur_sigma_pitch = 5; })), HasSubstr("wide"));
  EXPECT_THAT(refused(EdgePicture().picture(), {.axis = EdgeAxis::y}), HasSubstr("at most 46"));
}

TEST(SlantedEdge, RefusesAPictureWithoutAnEdge) {
  EXPECT_THAT(refused(cv::Mat1d(80, 41, 7.0)), HasSubstr("all pixels have the same value"));
  EXPECT_THAT(refused(EdgePicture().noisy(0.6, 1)), HasSubstr("edge"));
  EXPECT_THAT(refused(cv::Mat1d(9, 41, 7.0)), HasSubstr("smaller"));
  cv::Mat1d broken = EdgePicture().picture();
  broken(3, 3) = std::nan("");
  EXPECT_THAT(refused(broken), HasSubstr("not finite"));
}

TEST(SlantedEdge, RefusesABentEdge) {
  const EdgePicture made;
  cv::Mat1d picture(80, 41);
  for (int y = 0; y < picture.rows; ++y) {
    const double middle = 20.2 + std::pow((y - 39.5) / 39.5, 2);
    for (int x = 0; x < picture.cols; ++x)
      picture(y, x) = made.profile((x - middle) * made.cosine() + (y - 39.5) * made.sine());
  }
  EXPECT_THAT(refused(picture), HasSubstr("bent by 1.0"));
}

// A test picture, where each pixel is the mean over its area: the ends of its profile are corners that no clip made.
TEST(SlantedEdge, OfADetectorWithoutBlurIsNoClippedOne) {
  for (const double angle_deg : {2.0, 5.0, 12.0}) {
    const EdgePicture made{1e-4, 1, angle_deg, 50.3, 120, 100};
    cv::Mat1d picture = made.picture();
    for (double& value : picture) value = static_cast<float>(value);  // as in a file

    const auto edge = slanted_edge(picture, {});

    ASSERT_TRUE(edge) << angle_deg << " " << edge.error().message;
    EXPECT_LT(error_of(*edge, made, 0.5), 0.005) << angle_deg;
  }
}

TEST(SlantedEdge, RefusesAClippedEdgeWithAndWithoutNoiseOnEitherSide) {
  for (const double blur : {0.3, 0.7, 1.5}) {
    const EdgePicture made{.blur_sigma_pitch = blur};
    for (const double noise : {0.0, 0.01}) {
      const cv::Mat1d picture = made.noisy(noise, 3);
      EXPECT_THAT(refused(cv::min(picture, 0.85)), HasSubstr("bright side of the edge is clipped")) << blur;
      EXPECT_THAT(refused(cv::max(picture, 0.15)), HasSubstr("dark side of the edge is clipped")) << blur;
      EXPECT_THAT(refused(cv::max(cv::min(picture, 0.85), 0.15)), HasSubstr("clipped")) << blur;
    }
    EXPECT_THAT(refused(cv::min(made.noisy(0.01, 3), 1.0)), HasSubstr("bright side of the edge is clipped")) << blur;
  }
}

TEST(SlantedEdge, TakesRoundedPicturesForWhatTheyAre) {
  for (const double blur : {0.1, 0.5, 2.0}) {
    const EdgePicture made{.blur_sigma_pitch = blur};
    cv::Mat1d picture = 200 * made.picture() + 20;
    for (double& value : picture) value = std::round(value);

    const auto edge = slanted_edge(picture, {}).value();

    // A step of 200 counts is rounded to 0.3/200 of itself.
    EXPECT_LT(error_of(edge, made, 0.5), 0.006) << blur;
  }
}

// Levels between two counts and steps of few counts: rounding leaves corners, plateaus of two counts, and far fields
// that change by a count, none of which is clipping or shading.
TEST(SlantedEdge, KnowsWhatRoundingDoesToALevelBetweenTwoCounts) {
  for (const double step : {20.0, 50.0, 204.0}) {
    for (const double low : {25.5, 25.2, 25.0}) {
      for (const auto& [blur, angle] : {std::pair(0.25, 8.0), std::pair(0.35, 5.0), std::pair(0.8, 5.0)}) {
        const EdgePicture made{.blur_sigma_pitch = blur, .angle_deg = angle};
        cv::Mat1d picture = step * made.picture() + low;
        for (double& value : picture) value = std::round(value);

        const auto edge = slanted_edge(picture, {});

        ASSERT_TRUE(edge) << step << " " << low << " " << blur << ": " << edge.error().message;
        // Half counts: a bright field that is rounded up only where nothing at all is missing from its level.
        EXPECT_LT(error_of(*edge, made, 0.5), (low == 25.5 ? 3.3 : 1.3) / step) << step << " " << low << " " << blur;
        EXPECT_EQ(edge->shading_percent, 0) << step << " " << low << " " << blur;
        int held = 0;
        for (std::size_t i = 1; i <= 50; ++i) {
          const double truth = made.mtf(edge->frequency_per_pitch[i]);
          held += edge->mtf_low[i] <= truth && truth <= edge->mtf_high[i] ? 1 : 0;
        }
        EXPECT_GE(held, 45) << step << " " << low << " " << blur;
      }
    }
  }
}

}  // namespace
}  // namespace todbench
