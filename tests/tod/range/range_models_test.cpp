// SPDX-License-Identifier: GPL-3.0-or-later
// Range models, MRTD formula and sampled bars against closed forms and the reference numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/source_file.h"
#include "tod/range/bars_sampled.h"
#include "tod/range/criterion_range.h"
#include "tod/range/eye_ctf.h"
#include "tod/range/mrtd_formula.h"
#include "tod/range/probability_forms.h"
#include "tod/range/range_prediction.h"

namespace todbench {
namespace {

/// The files give ten significant digits.
constexpr double ten_digits = 1e-8;

nlohmann::json cases(const std::string& name, const std::string& kind) {
  std::ifstream file(source_file("tests/golden/reference_" + name + "_shared.json"));
  nlohmann::json found = nlohmann::json::parse(file)["cases"][kind];
  EXPECT_FALSE(found.empty()) << name << ": " << kind;
  return found;
}

/// a exp(b f) up to `highest`, between which ln is linear: two points are all of it.
LogLinearCurve exponential(double a, double b, double highest) {
  return *LogLinearCurve::of(std::vector<CurvePoint>{{0, a}, {highest, a * std::exp(b * highest)}}, "test");
}

TEST(MrtdFormula, AgreesWithTheReference) {
  for (const auto& reference : cases("mrtd_ttp", "mrtd_formula")) {
    MrtdFormula formula;
    formula.pitch_mrad = reference["pitch_mrad"];
    formula.netd_k = reference["netd_k"];
    formula.frame_rate_hz = reference["frame_rate_hz"];
    formula.eye_integration_s = reference["eye_integration_s"];
    formula.snr_threshold = reference["snr_threshold"];
    const auto& ratio = reference["components_over_tvh"];
    formula.noise = {ratio["vh"], ratio["th"], ratio["tv"], ratio["h"], ratio["v"]};
    if (!reference["noise_filter_sigma_pitch"].is_null())
      formula.noise_filter_sigma_mrad = formula.pitch_mrad * reference["noise_filter_sigma_pitch"].get<double>();
    for (const auto& point : reference["points"]) {
      const double f = point["frequency_per_mrad"], mtf = point["system_mtf"];
      const double h = point["mrtd_h_k"], v = point["mrtd_v_k"];

      EXPECT_NEAR(mrtd_k(formula, f, mtf, BarAxis::horizontal) / h, 1, ten_digits);
      EXPECT_NEAR(mrtd_k(formula, f, mtf, BarAxis::vertical) / v, 1, ten_digits);
    }
  }
}

TEST(MrtdFormula, TheMtdpLikeCurveJoinsTheMrtdWhereTheModulationIsThatOfTheFirstHarmonic) {
  const MrtdFormula formula;

  for (const double mtf : {0.1, 0.5, 0.9}) {
    EXPECT_NEAR(mtdp_like_k(formula, 0.3, 4 / std::numbers::pi * mtf, BarAxis::horizontal),
                mrtd_k(formula, 0.3, mtf, BarAxis::horizontal), 1e-15);
  }
}

/// Variance of the mean over a bar of samples of which n neighbours along the axis are alike: brute force over where
/// the samples lie and which of them belong together.
double variance_over_bar(double pitch, double width, int alike) {
  constexpr int places = 4000;
  double sum = 0;
  for (int place = 0; place < places; ++place) {
    for (int first = 0; first < alike; ++first) {
      std::map<int, int> in_bar;  // samples by detector
      for (int i = 0; (i + (place + 0.5) / places) * pitch < width; ++i) ++in_bar[(i + first) / alike];
      for (const auto& [detector, samples] : in_bar) sum += samples * samples;
    }
  }
  return sum / places / alike * pitch * pitch / (width * width);
}

TEST(MrtdFormula, TheFixedPatternOfADetectorIsSharedByAllItsSamples) {
  MrtdFormula formula{.pitch_mrad = 0.5, .frame_rate_hz = 1e18, .noise = {.vh = 1}};
  for (const int n : {1, 2, 3}) {
    formula.samples_per_detector = n;
    for (const double f : {0.05, 0.3, 0.71, 1.3}) {
      const double width = 1 / (2 * f);
      const double expected = variance_over_bar(0.5, width, n) * variance_over_bar(0.5, 7 * width, n);

      const double found = perceived_noise_k(formula, f, BarAxis::horizontal) / formula.snr_threshold / formula.netd_k;

      EXPECT_NEAR(found * found / expected, 1, 2e-3) << n << " at " << f;
    }
    // The Dirichlet kernel.
    for (const double f : {0.01, 0.2, 0.49}) {
      const double kernel = std::sin(std::numbers::pi * n * f) / std::sin(std::numbers::pi * f);
      EXPECT_NEAR(shared_density(n, f), kernel * kernel / n, 1e-12);
    }
  }
}

TEST(ProbabilityForms, AgreeWithTheReferenceAndInvertIt) {
  for (const auto& reference : cases("mrtd_ttp", "probability_forms")) {
    ProbabilityForm form = ProbabilityForm::johnson;
    if (reference["exponent_a"] == 1.51) form = ProbabilityForm::ttp_2004;
    if (reference["exponent_a"] == 1.5) form = ProbabilityForm::fixed_1_5;
    for (const auto& [p, x] : reference["x_for_probability"].items())
      EXPECT_NEAR(ratio_for_probability(form, std::stod(p)), x.get<double>(), ten_digits);
    for (const auto& [x, p] : reference["probability_at_x"].items())
      EXPECT_NEAR(target_probability(form, std::stod(x)), p.get<double>(), ten_digits);
  }
}

TEST(ProbabilityForms, TheFormsOfTheTtpHaveTheirPublishedRatios) {
  // Sheet of facts: x at 0.5, 0.75, 0.8, 0.9, four decimals.
  const std::vector<double> p{0.5, 0.75, 0.8, 0.9};
  const std::vector<double> of_2004{1, 1.7650, 2.0060, 2.7520}, fixed{1, 2.0801, 2.5198, 4.3267};
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(ratio_for_probability(ProbabilityForm::ttp_2004, p[i]), of_2004[i], 5e-5);
    EXPECT_NEAR(ratio_for_probability(ProbabilityForm::fixed_1_5, p[i]), fixed[i], 5e-5);
  }
  EXPECT_EQ(target_probability(ProbabilityForm::ttp_2004, 0), 0);
  EXPECT_EQ(target_probability(ProbabilityForm::johnson, 1e6), 1);
  for (const double tiny : {1e-12, 0.001, 0.3})
    EXPECT_NEAR(
        target_probability(ProbabilityForm::johnson, ratio_for_probability(ProbabilityForm::johnson, tiny)) / tiny, 1,
        1e-9);
}

TEST(Acquire, AgreesWithTheClosedFormOfTheReference) {
  for (const auto& reference : cases("mrtd_ttp", "acquire")) {
    const auto resolved = resolved_cycles(exponential(reference["a_k"], reference["b_mrad"], 20));
    const CriterionTarget target{reference["critical_dimension_m"], reference["delta_t_k"]};
    const auto air = Transmittance::beer_lambert(reference["extinction_per_km"]);
    const Criterion criterion{reference["cycles_50"], ProbabilityForm::johnson};
    const double expected_m = 1000 * reference["range50_km"].get<double>();

    const auto found = range_for_probability(resolved, target, air, criterion, 0.5);

    ASSERT_TRUE(found.range_m) << found.reason;
    EXPECT_NEAR(*found.range_m / expected_m, 1, ten_digits);
    // R50 = h ln(dT / a) / (N50 b + h K): its derivatives in closed form; differences of 1 % are off by half of it.
    const double h = target.size_m, n = criterion.at_half;
    const double b = reference["b_mrad"], k = reference["extinction_per_km"], a = reference["a_k"];
    ASSERT_TRUE(found.sensitivity);
    EXPECT_NEAR(found.sensitivity->to_size, n * b / (n * b + h * k), 0.01);
    EXPECT_NEAR(found.sensitivity->to_contrast, 1 / std::log(target.contrast / a), 0.01);
    for (const auto& [share, p] : reference["probability"].items()) {
      const auto x = criterion_ratio(resolved, target, air, criterion, std::stod(share) * expected_m);
      EXPECT_NEAR(target_probability(criterion.form, x.value()), p.get<double>(), 1e-7);
    }
  }
}

TEST(Acquire, TwoEqualAxesAreTheOneAndNothingIsPromisedBelowTheCurve) {
  const auto curve = exponential(0.01, 6, 1);
  const auto one = resolved_cycles(curve), two = resolved_cycles(curve, curve);
  EXPECT_DOUBLE_EQ(one(0.5).value(), two(0.5).value());
  EXPECT_FALSE(one(0.0099));
  EXPECT_EQ(one(1e9), 1.0);

  // With air the contrast reaches the curve's lowest point at 1000 ln(200) / 5 m, long before one cycle is lost.
  const auto found = range_for_probability(
      resolved_cycles(*LogLinearCurve::of(std::vector<CurvePoint>{{0.9, 0.01}, {1, 0.02}}, "MRTD")), {100, 2},
      Transmittance::beer_lambert(5), {1, ProbabilityForm::johnson}, 0.5);
  EXPECT_FALSE(found.range_m);
  ASSERT_TRUE(found.at_least_m);
  EXPECT_NEAR(*found.at_least_m, 1000 * std::log(200) / 5, 1e-6);
  EXPECT_FALSE(found.reason.empty());
}

TEST(Eye, AgreesWithTheReference) {
  for (const auto& reference : cases("mrtd_ttp", "eye_ctf")) {
    const EyeConditions eye{reference["luminance_cd_m2"], reference["field_degrees"], reference["eyes"]};
    for (std::size_t i = 0; i < reference["ctf"].size(); ++i) {
      const double expected = reference["ctf"][i];
      EXPECT_NEAR(eye_contrast_threshold(reference["frequency_cycles_per_degree"][i], eye) / expected, 1, ten_digits);
    }
  }
}

TEST(Ttp, AgreesWithTheClosedFormOfTheReference) {
  for (const auto& reference : cases("mrtd_ttp", "ttp")) {
    const auto curve = exponential(reference["C0"], 1 / reference["f0_per_mrad"].get<double>(), 20);
    const auto resolved = resolved_values(curve);
    const CriterionTarget target{reference["size_m"], reference["target_contrast"]};
    const auto air = Transmittance::beer_lambert(reference["extinction_per_km"]);
    const Criterion criterion{reference["V50"], ProbabilityForm::ttp_2004};

    EXPECT_NEAR(resolved(target.contrast).value() / reference["integral_at_zero_range"].get<double>(), 1, ten_digits);
    EXPECT_NEAR(criterion_ratio(resolved, target, air, criterion, 1000).value() * criterion.at_half /
                    reference["V_at_1_km"].get<double>(),
                1, ten_digits);
    for (const auto& [p, range_km] : reference["range_km"].items()) {
      const auto found = range_for_probability(resolved, target, air, criterion, std::stod(p));
      ASSERT_TRUE(found.range_m) << found.reason;
      EXPECT_NEAR(*found.range_m / 1000 / range_km.get<double>(), 1, ten_digits);
    }
  }
}

TEST(Ttp, IntegralOfEachAxisIsThatOfTheReference) {
  for (const auto& reference : cases("mrtd_ttp", "ttp_two_axes")) {
    const auto h = exponential(reference["horizontal"][0], 1 / reference["horizontal"][1].get<double>(), 20);
    const auto v = exponential(reference["vertical"][0], 1 / reference["vertical"][1].get<double>(), 20);
    const double contrast = reference["contrast"];

    EXPECT_NEAR(h.root_excess_integral(contrast), reference["integral_h"].get<double>(), ten_digits);
    EXPECT_NEAR(v.root_excess_integral(contrast), reference["integral_v"].get<double>(), ten_digits);
  }
}

TEST(Ttp, OnlyFrequenciesBelowTheContrastCountAtBothEnds) {
  // Falls from 1 to 0.01 and rises again: of each side the part below 0.1, sqrt(0.1 / CTF) from 1 to sqrt(10).
  const auto curve = LogLinearCurve::of(std::vector<CurvePoint>{{0, 1}, {1, 0.01}, {2, 1}}, "CTF");

  // Half a unit on each side, exponent from 0 to ln(10) / 2.
  const double side = 0.5 * (std::sqrt(10) - 1) / (std::log(10) / 2);
  EXPECT_NEAR(curve->root_excess_integral(0.1), 2 * side, 1e-14);
  EXPECT_EQ(curve->root_excess_integral(0.01), 0);
}

double gaussian_detector(double f, double detector, double sigma) {
  const double x = std::numbers::pi * f * detector;
  return (x == 0 ? 1 : std::sin(x) / x) * std::exp(-2 * std::pow(std::numbers::pi * sigma * f, 2));
}

TEST(BarsSampled, AgreeWithTheReference) {
  for (const auto& reference : cases("bars_sampled", "bars_sampled")) {
    const double detector = reference["detector_pitch"], sigma = reference["blur_sigma_pitch"];
    // exp(-2 pi^2 sigma^2 f^2) = 1e-17 there.
    const double band = std::sqrt(17 * std::log(10) / 2) / (std::numbers::pi * sigma);
    const BlurredBars bars(
        reference["frequency_cycles_per_pitch"], [&](double f) { return gaussian_detector(f, detector, sigma); }, band);
    const auto& samples = reference["samples_at_best_phase"];
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_NEAR(bars.at(reference["first_sample_at"].get<double>() + static_cast<double>(i)),
                  samples[i].get<double>(), 1e-9);
    }

    const auto found = bar_modulation(bars, reference["phases"]);

    EXPECT_NEAR(found.best, reference["modulation_best"].get<double>(), 1e-9);
    EXPECT_NEAR(found.mean, reference["modulation_mean"].get<double>(), 1e-9);
    EXPECT_NEAR(found.worst, reference["modulation_worst"].get<double>(), 1e-9);
    EXPECT_EQ(found.bars_separated_at_best, reference["bars_separated_best"].get<int>());
    EXPECT_NEAR(found.share_of_four, reference["share_of_phases_with_four_bars"].get<double>(), 1e-12);
  }
}

TEST(LogLinear, RefusesWhatIsNoCurve) {
  using Points = std::vector<CurvePoint>;
  for (const Points& points : {Points{}, Points{{1, 1}}, Points{{1, 1}, {1, 2}}, Points{{2, 1}, {1, 2}},
                               Points{{1, 0}, {2, 1}}, Points{{1, 1}, {2, NAN}}, Points{{-1, 1}, {2, 1}}})
    EXPECT_FALSE(LogLinearCurve::of(points, "MRTD").has_value());
}

}  // namespace
}  // namespace todbench
