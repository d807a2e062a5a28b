// SPDX-License-Identifier: GPL-3.0-or-later
// Formula curves of a simulated sensor.
#include "sim_devices/prediction/formula_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tests/sim_devices/reference.h"

namespace todbench {
namespace {

TEST(FormulaCurves, MrtdOfTheSc2000IsTheFormulaAndEndsAtNyquist) {
  const SensorSpec spec = test::sc2000();
  const FormulaConditions conditions;

  const auto curves = mrtd_curves(spec, conditions);

  ASSERT_TRUE(curves) << curves.error().message;
  const auto& last = curves->horizontal.points().back();
  EXPECT_NEAR(last.frequency, 0.5 / spec.ifov_mrad(), 1e-12);
  const SensorPlan plan = full_plan(spec, {}, {});
  const double mtf = OpticsMtf(spec, plan, 16)(0.5) * FootprintMtf({.spec = spec, .plan = plan})(0.5, PitchAxis::x);
  const MrtdFormula formula{.pitch_mrad = spec.ifov_mrad(), .netd_k = 0.07, .frame_rate_hz = 50};
  EXPECT_NEAR(last.value / mrtd_k(formula, last.frequency, mtf, BarAxis::horizontal), 1, 1e-12);
}

TEST(FormulaCurves, AveragingAndMicroscanChangeNeitherNoisePerAngleAndTimeNorTheWhiteMrtd) {
  SensorSpec averaged = test::sc2000(), scanned = test::sc2000();
  averaged.frames_averaged = 4;
  scanned.microscan = 2;
  const FormulaConditions conditions;
  const auto plain = mrtd_curves(test::sc2000(), conditions);

  // White noise density NETD^2 p^2 / F: the same in all three; microscan has twice the Nyquist frequency.
  const auto a = mrtd_curves(averaged, conditions), b = mrtd_curves(scanned, conditions);
  EXPECT_NEAR(a->horizontal.at(0.3).value() / plain->horizontal.at(0.3).value(), 1, 1e-12);
  EXPECT_NEAR(b->horizontal.at(0.3).value() / plain->horizontal.at(0.3).value(), 1, 1e-3) << "between points";
  EXPECT_NEAR(b->horizontal.points().back().frequency, 2 * plain->horizontal.points().back().frequency, 1e-12);
}

TEST(FormulaCurves, MicroscanTakesNothingFromTheFixedPatternOfTheSameDetectors) {
  SensorSpec plain = test::sc2000();
  plain.netd_k = 1e-4;
  plain.fixed_pattern_k = 0.1;
  SensorSpec scanned = plain, quiet = plain, quiet_scanned = plain;
  scanned.microscan = quiet_scanned.microscan = 2;
  quiet.fixed_pattern_k = quiet_scanned.fixed_pattern_k = 0;
  const FormulaConditions conditions;
  const double f = 0.1, low = 0.02;

  const auto one = mrtd_curves(plain, conditions), four = mrtd_curves(scanned, conditions);
  ASSERT_TRUE(one && four);
  // Bars of 7.6 samples by 53: (1 - p / 2 w) of the mean over pairs of samples that begin anywhere.
  const double sample = plain.ifov_mrad() / 2, width = 1 / (2 * f);
  const double expected = std::sqrt((1 - sample / (2 * width)) * (1 - sample / (14 * width)));
  EXPECT_NEAR(four->horizontal.at(f).value() / one->horizontal.at(f).value() / expected, 1, 5e-3);
  // Over CTFs without the pattern, the noise that the eye's channel lets through.
  const auto noise = [&](const SensorSpec& with, const SensorSpec& without) {
    const double ratio =
        system_ctf(with, conditions)->at(low).value() / system_ctf(without, conditions)->at(low).value();
    return ratio * ratio - 1;
  };
  EXPECT_NEAR(noise(scanned, quiet_scanned) / noise(plain, quiet), 1, 0.02);
}

TEST(FormulaCurves, TheMtdpLikeCurveGoesOnBeyondNyquistAndJoinsTheMrtdWhenSamplingIsFine) {
  const FormulaConditions conditions;
  const auto mtdp = mtdp_like_curves(test::sc2000(), conditions);
  ASSERT_TRUE(mtdp) << mtdp.error().message;
  EXPECT_GT(mtdp->horizontal.points().back().frequency, 0.5 / test::sc2000().ifov_mrad());

  SensorSpec fine = test::sc2000();
  fine.microscan = 4;
  const auto joined = mtdp_like_curves(fine, conditions), mrtd = mrtd_curves(fine, conditions);
  ASSERT_TRUE(joined && mrtd);
  // Where the third harmonic is nearly gone: 1.2 cycles/pitch have an MTF of a few per cent.
  const double f = 0.55 / fine.ifov_mrad();
  EXPECT_NEAR(joined->horizontal.at(f).value() / mrtd->horizontal.at(f).value(), 1, 0.1);
}

/// The end from another program: bars by FFT on 96 points a sample, 16 phases, frequency halved to 1e-5 of Nyquist.
TEST(FormulaCurves, TheMtdpLikeCurveEndsWhereTwoBarsAreApartNoMore) {
  const double nyquist = 0.5 / test::sc2000().ifov_mrad();

  const auto mtdp = mtdp_like_curves(test::sc2000(), FormulaConditions{});

  ASSERT_TRUE(mtdp) << mtdp.error().message;
  EXPECT_NEAR(mtdp->horizontal.points().back().frequency / nyquist, 1.76702, 4e-4);
}

TEST(FormulaCurves, TheSystemCtfLiesAboveTheEyesAndFallsWithLessNoise) {
  const FormulaConditions conditions;
  SensorSpec quiet = test::sc2000();
  quiet.netd_k = 0;
  const auto noisy_curve = system_ctf(test::sc2000(), conditions), quiet_curve = system_ctf(quiet, conditions);

  ASSERT_TRUE(noisy_curve && quiet_curve);
  const double f = 0.2;
  // A sample is shown under 1 mrad: cycles per degree at the eye.
  const double magnification = conditions.sample_at_eye_mrad / quiet.ifov_mrad();
  const double eye = eye_contrast_threshold(f / magnification * 1000 * std::numbers::pi / 180, conditions.eye);
  EXPECT_GT(quiet_curve->at(f).value(), eye);
  EXPECT_GT(noisy_curve->at(f).value(), quiet_curve->at(f).value());
}

TEST(FormulaCurves, ASensorWithoutNoiseHasNoMrtd) {
  SensorSpec spec = test::sc2000();
  spec.netd_k = 0;

  EXPECT_FALSE(mrtd_curves(spec, {}));
  EXPECT_FALSE(mtdp_like_curves(spec, {}));
}

}  // namespace
}  // namespace todbench
