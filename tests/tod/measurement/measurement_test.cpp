// SPDX-License-Identifier: GPL-3.0-or-later
// The measurement on simulated cameras: agreement with the direct estimate, contrast, phases, repetition.
#include "tod/measurement/measurement.h"

#include <gmock/gmock.h>

#include <cmath>

#include "sim_devices/prediction/contrast_response.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tests/tod/measurement/measurement_bench.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

using test::options_of;
using test::run;
using test::SimulatedBench;

TodCurve curve_of(const Result<MeasurementResult>& result) {
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  if (!result) return {};
  EXPECT_FALSE(result->ended_by.has_value());
  auto curve = tod_curve(result->trials, {});
  EXPECT_TRUE(curve.has_value());
  return curve ? *curve : TodCurve{};
}

TEST(Measurement, OfTheSimulatedSC2000AgreesWithTheDirectEstimate) {
  SimulatedBench bench;
  bench.phases = 12;
  TemplateObserver observer({}, triangle_alternatives());

  const TodCurve curve = curve_of(run(bench, observer, options_of(bench)));

  const auto direct = direct_estimate(bench.spec, full_plan(bench.spec, {}, {}), observer, bench.contrasts, {});
  ASSERT_TRUE(direct.has_value());
  ASSERT_EQ(curve.points.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& point = curve.points[i];
    const double expected = (*direct)[i].s75_pitch * bench.spec.ifov_mrad();
    ASSERT_TRUE(point.fit.usable());
    // The true curve is no Weibull: a bias of -1.4 % to +4 % that no number of trials removes; and three standard
    // errors.
    EXPECT_NEAR(*point.fit.threshold, expected, 0.04 * expected + 1.5 * (*point.fit.ci95.high - *point.fit.threshold));
  }
}

TEST(Measurement, ReadsTheContrastThatTheCameraSeesNotTheOneThatWasSet) {
  SimulatedBench bench;
  bench.contrasts = {16.9, 0.23};
  TemplateObserver observer({}, triangle_alternatives());
  MeasurementOptions options = options_of(bench);
  const SensorModel model(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::normal(), 1);
  RegistrationOptions registration;
  registration.expected_scale_px_per_mm = 1 / (2 * bench.spec.ifov_mrad());
  for (const auto& plate : bench.plates) {
    options.contrast_response[plate.name] =
        contrast_response(model, plate, 2, options.min_reference_px, registration).value();
  }

  const TodCurve curve = curve_of(run(bench, observer, options));

  for (const auto& [name, response] : options.contrast_response) {
    EXPECT_GT(response, 0.95);
    EXPECT_LT(response, 1);
  }
  // Noise 0.07 K / sqrt(16 frames) per pixel, some ten inner pixels in each of four to eight triangles, eight set-ups:
  // below 1 mK.
  ASSERT_EQ(curve.points.size(), 2u);
  EXPECT_NEAR(curve.points[0].delta_t_k, 16.9, 0.03);
  EXPECT_NEAR(curve.points[1].delta_t_k, 0.23, 0.003);
}

TEST(Measurement, SpreadsPhasesEvenlyAndRecordsThem) {
  SimulatedBench bench;
  bench.contrasts = {16.9};
  bench.phases = 8;
  TemplateObserver observer({}, triangle_alternatives());

  const auto result = run(bench, observer, options_of(bench));

  ASSERT_TRUE(result.has_value());
  std::array<double, 4> quadrant{};
  for (const auto& trial : result->trials) {
    ASSERT_GE(trial.phase_x_px, -0.5);
    ASSERT_LT(trial.phase_x_px, 0.5);
    quadrant[(trial.phase_x_px < 0 ? 0u : 1u) + (trial.phase_y_px < 0 ? 0u : 2u)] += 1;
  }
  const double n = static_cast<double>(result->trials.size());
  // Spread on purpose: better than chance, whose standard deviation of a quadrant is sqrt(n 3/16).
  for (const double count : quadrant) EXPECT_NEAR(count, n / 4, 2 * std::sqrt(n * 3 / 16));
}

TEST(Measurement, RepeatsBitForBit) {
  SimulatedBench bench;
  bench.contrasts = {0.23};
  bench.phases = 2;
  TemplateObserver observer({}, triangle_alternatives());

  const auto a = run(bench, observer, options_of(bench));
  const auto b = run(bench, observer, options_of(bench));

  ASSERT_TRUE(a.has_value() && b.has_value());
  ASSERT_EQ(a->trials.size(), b->trials.size());
  for (std::size_t i = 0; i < a->trials.size(); ++i) {
    EXPECT_EQ(a->trials[i].answer, b->trials[i].answer);
    EXPECT_EQ(a->trials[i].scores, b->trials[i].scores);
    EXPECT_EQ(a->trials[i].delta_t_k, b->trials[i].delta_t_k);
  }
}

TEST(Measurement, GradedAnswersStandBesideTheSameAnswers) {
  SimulatedBench bench;
  bench.contrasts = {1.93};
  bench.phases = 3;
  TemplateObserver observer({}, triangle_alternatives());
  MeasurementOptions graded = options_of(bench);
  graded.answers = AnswerKind::graded;

  const auto binary = run(bench, observer, options_of(bench));
  const auto one = run(bench, observer, graded);
  graded.frames_per_presentation = 4;
  const auto four = run(bench, observer, graded);
  graded.frames_at_contrast[1.93] = 2;
  const auto two = run(bench, observer, graded);

  ASSERT_TRUE(binary && one && four && two);
  EXPECT_EQ(two->frames_used, binary->frames_used + two->presentations.size());
  EXPECT_EQ(two->trials.front().frames, 2);
  EXPECT_EQ(one->frames_used, binary->frames_used);
  EXPECT_EQ(four->frames_used, binary->frames_used + 3 * four->presentations.size());
  ASSERT_EQ(one->trials.size(), binary->trials.size());
  double difference = 0, variance = 0, squares_one = 0, squares_four = 0;
  for (std::size_t i = 0; i < one->trials.size(); ++i) {
    EXPECT_FALSE(binary->trials[i].probability_correct);
    ASSERT_TRUE(one->trials[i].probability_correct && four->trials[i].probability_correct);
    Trial same = one->trials[i];
    same.probability_correct.reset();
    same.host_time_ns = binary->trials[i].host_time_ns;  // of this host's clock
    EXPECT_EQ(same, binary->trials[i]);
    EXPECT_EQ(four->trials[i].frames, 4);
    const double p = *one->trials[i].probability_correct;
    difference += (one->trials[i].correct() ? 1 : 0) - p;
    variance += p * (1 - p);
    squares_one += p * p;
    squares_four += std::pow(*four->trials[i].probability_correct, 2);
  }
  // An answer is one draw with that probability. The draws behind the probability add a 32nd to its variance.
  EXPECT_LT(std::abs(difference), 4 * std::sqrt(1.04 * variance));
  EXPECT_LT(squares_four, squares_one) << "averages spread less";
}

}  // namespace
}  // namespace todbench
