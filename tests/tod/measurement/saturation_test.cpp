// SPDX-License-Identifier: GPL-3.0-or-later
// Targets that the camera's counts cannot show, and pixels that always read full scale.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tests/tod/measurement/faulty_bench.h"
#include "tod/measurement/saturation_watch.h"
#include "tod/measurement/set_up_step.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

struct Camera {
  const char* name;
  int bits;
  double kelvin_per_count, offset_k, contrast_k;
  bool clips;
};

void PrintTo(const Camera& camera, std::ostream* out) {
  *out << camera.name;
}

test::SmallBench bench_of(const Camera& camera) {
  test::SmallBench bench;
  bench.spec.bits = camera.bits;
  bench.spec.kelvin_per_count = camera.kelvin_per_count;
  bench.spec.offset_k = camera.offset_k;
  bench.contrasts = {camera.contrast_k};
  bench.model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::draft(), 1);
  return bench;
}

double saturated_share(const MeasurementResult& result) {
  const auto curve = tod_curve(result.trials, {});
  EXPECT_TRUE(curve);
  return curve ? curve->points[0].saturated_share : -1;
}

class TargetsBeyondTheCounts : public ::testing::TestWithParam<Camera> {};

TEST_P(TargetsBeyondTheCounts, AreToldFromThoseWithin) {
  const test::SmallBench bench = bench_of(GetParam());
  const auto source = bench.camera();
  MeasurementOptions options = test::options_of(bench);
  options.integrity.max_saturated_share = 0.2;  // the triangles of this small plate are many

  const auto result = bench.run(*source, options);

  ASSERT_TRUE(result) << result.error().message;
  ASSERT_FALSE(result->ended_by) << result->ended_by->message;
  if (GetParam().clips) {
    EXPECT_GT(saturated_share(*result), 0.5);
    EXPECT_THAT(result->notes, Contains(HasSubstr("at an end of the camera's counts")));
  } else {
    EXPECT_EQ(saturated_share(*result), 0);
    EXPECT_THAT(result->notes, Not(Contains(HasSubstr("at an end of the camera's counts"))));
  }
}

INSTANTIATE_TEST_SUITE_P(All, TargetsBeyondTheCounts,
                         ::testing::Values(Camera{"the_upper_end_of_14_bits", 14, 0.01, 250, 300, true},
                                           Camera{"within_14_bits", 14, 0.01, 250, 16.9, false},
                                           Camera{"cold_below_zero_counts", 14, 0.01, 290, -40, true},
                                           Camera{"cold_within", 14, 0.01, 290, -8, false},
                                           Camera{"the_upper_end_of_8_bits", 8, 0.1, 295, 30, true},
                                           Camera{"within_8_bits", 8, 0.1, 295, 16.9, false},
                                           Camera{"the_upper_end_of_16_bits", 16, 0.001, 250, 30, true}),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(Saturation, OfAPictureIsToldFromSingleStuckPixels) {
  AveragedPicture picture;
  picture.significant_bits = 10;
  picture.lowest = cv::Mat1w(100, 100, std::uint16_t{990});
  picture.highest = cv::Mat1w(100, 100, std::uint16_t{1010});
  picture.lowest(5, 5) = picture.highest(5, 5) = 1023;
  EXPECT_FALSE(saturated(picture));

  picture.lowest(cv::Rect(20, 20, 10, 10)) = 1023;
  picture.highest(cv::Rect(20, 20, 10, 10)) = 1023;
  EXPECT_TRUE(saturated(picture));
}

TEST(Saturation, ThatHidesTheShapesOfThePlateIsNamedInsteadOfAnotherPlate) {
  // Counts end 0.23 K above the surround, so blur moves the visible edges of triangles of 30 K outwards.
  const test::SmallBench bench = bench_of({"", 10, 0.01, 290, 30, true});
  const auto source = bench.camera();
  MeasurementOptions options = test::options_of(bench);
  options.integrity.max_saturated_share = 1;

  const auto result = bench.run(*source, options);

  const std::string reason = !result ? result.error().message : result->ended_by ? result->ended_by->message : "";
  EXPECT_THAT(reason, HasSubstr("the picture is saturated"));
}

TEST(UnexpectedSign, IsCalledWrongOnlyIfTheContrastIsCertain) {
  const auto said = [](double set_k, double value, double standard_error, std::optional<double> kelvin_per_count) {
    EffectiveContrast observed;
    observed.value = value, observed.standard_error = standard_error;
    return unexpected_sign(set_k, observed, ContrastUnit::kelvin, kelvin_per_count);
  };

  EXPECT_THAT(said(0.5, 0, 0, 5), HasSubstr("the contrast is below one count of the camera (5 K)"));
  EXPECT_THAT(said(0.5, -0.219, 0.225, 0.01), HasSubstr("not seen above the noise"));
  EXPECT_THAT(said(0.5, -0.219, 0.225, 0.01), Not(HasSubstr("sign")));
  EXPECT_THAT(said(0.5, -0.5, 0.01, 0.01), HasSubstr("one of them has the wrong sign"));
}

/// Counts that end where no format does: fewer bits than the format has, or the end of a temperature range.
TEST(Saturation, IsSeenWhereCountsStopBelowFullScale) {
  const test::SmallBench bench = bench_of({"", 16, 0.01, 250, 30, true});
  test::DisturbedSource source(bench.camera(), [](std::uint64_t, Frame frame) -> Result<Frame> {
    frame.counts = cv::min(frame.counts, 7000);  // 320 K; the surround is at 5000
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_TRUE(result) << result.error().message;
  EXPECT_GT(saturated_share(*result), 0.5);
}

TEST(Saturation, OfPixelsThatAlwaysReadFullScaleRejectsNothing) {
  const test::SmallBench bench = bench_of({"", 14, 0.01, 250, 16.9, false});
  const auto& triangle = bench.plates[0].triangles[0];
  const cv::Point2d place =
      scene_pixel(*bench.holder->scene(), triangle.position_mm, bench.spec.ifov_mrad(), bench.model->size());
  test::DisturbedSource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    frame.counts = frame.counts.clone();
    frame.counts(cvRound(place.y), cvRound(place.x) + 1) = 16383;  // in the window of a triangle
    for (int k = 0; k < 10; ++k) frame.counts(2 + 20 * k, 3) = k % 2 == 0 ? 16383 : 0;
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(saturated_share(*result), 0);
}

TEST(Saturation, OfAPixelThatReadsFullScaleForOneFrameMarksItsTrial) {
  const test::SmallBench bench = bench_of({"", 14, 0.01, 250, 16.9, false});
  const auto& triangle = bench.plates[0].triangles[0];
  const cv::Point2d place =
      scene_pixel(*bench.holder->scene(), triangle.position_mm, bench.spec.ifov_mrad(), bench.model->size());
  // Frames of registration and contrast come first.
  const auto before =
      static_cast<std::uint64_t>(test::options_of(bench).registration_frames + test::options_of(bench).contrast_frames);
  test::DisturbedSource source(bench.camera(), [&](std::uint64_t index, Frame frame) -> Result<Frame> {
    if (index < before) return frame;
    frame.counts = frame.counts.clone();
    frame.counts(cvRound(place.y), cvRound(place.x)) = 16383;
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_TRUE(result) << result.error().message;
  for (const Trial& trial : result->trials)
    EXPECT_EQ(trial.saturated_pixels, trial.triangle == triangle.name ? 1 : 0) << trial.triangle;
}

TEST(TimeCorrelation, OfMeasuredFramesIsThatOfTheSensor) {
  test::SmallBench bench;
  bench.contrasts = {16.9};
  const auto correlation_at = [&](double rho) {
    SensorSpec spec = bench.spec;
    spec.noise_correlation = rho;
    bench.model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), 1);
    const auto source = bench.camera();
    const auto result = bench.run(*source, test::options_of(bench));
    EXPECT_TRUE(result);
    EXPECT_TRUE(result && result->lag1_correlation);
    // Successive frames show the root of 1 - rho of the noise; 76800 pixels and 31 differences know it to 0.1 %.
    EXPECT_NEAR(result->temporal_noise_k / (spec.netd_k * std::sqrt(1 - rho)), 1, 0.02);
    EXPECT_NEAR(*result->temporal_noise_counts / (7 * std::sqrt(1 - rho)), 1, 0.02);
    return *result->lag1_correlation;
  };

  EXPECT_NEAR(correlation_at(0), 0, 0.01);
  EXPECT_NEAR(correlation_at(0.8), 0.8, 0.02);
}

TEST(SetUpPicture, IsShownOncePerContrastWithItsNoiseAndItsAnswerDividesContrasts) {
  test::SmallBench bench;
  bench.spec.column_noise_k = 0.07;
  bench.spec.row_noise_k = 0.03;
  bench.model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::draft(), 1);
  MeasurementOptions options = test::options_of(bench);
  std::vector<cv::Vec2d> variances;
  options.learn_response = [&](const SetUpPicture& found) -> std::map<std::string, double> {
    variances.emplace_back(found.picture.row_variance_k2.value_or(-1), found.picture.column_variance_k2.value_or(-1));
    return {{found.state.plate, 0.5}};
  };

  const auto result = bench.run(*bench.camera(), options);

  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(variances.size(), 2u);
  // 15 differences of 240 rows and 320 columns that share frames: sqrt(3 / 3600) and sqrt(3 / 4800) of the variance.
  EXPECT_NEAR(variances[0][0], 0.0009, 5 * 0.0009 * 0.029);
  EXPECT_NEAR(variances[0][1], 0.0049, 5 * 0.0049 * 0.025);
  ASSERT_FALSE(result->contrasts.empty());
  EXPECT_NEAR(result->contrasts.front().delta_t_k / 16.9, 2, 0.1);
}

}  // namespace
}  // namespace todbench
