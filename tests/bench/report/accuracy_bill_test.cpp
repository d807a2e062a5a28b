// SPDX-License-Identifier: GPL-3.0-or-later
// What the time of a run bought.
#include "bench/report/accuracy_bill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Two set-ups of two contrasts and three places each. A change takes 2 s, a presentation 1 s, and the first of a
/// set-up or contrast 4 s more.
std::vector<Presentation> run_of_twelve() {
  std::vector<Presentation> out;
  double now_s = 100;
  for (const char* plate : {"a", "b"}) {
    for (const double delta_t_k : {16.9, 0.5}) {
      for (int place = 0; place < 3; ++place) {
        now_s += 2;
        Presentation shown;
        shown.presentation = static_cast<std::int64_t>(out.size());
        shown.set = {.plate = plate, .mounting = Mounting::identity, .delta_t_k = delta_t_k};
        shown.said.settling_s = 2;
        shown.host_time_ns = std::llround(now_s * 1e9);
        out.push_back(shown);
        now_s += place == 0 ? 5 : 1;
      }
    }
  }
  return out;
}

TodPoint point(double set_delta_t_k, double s75_mrad, double half_width_percent) {
  TodPoint out;
  out.set_delta_t_k = out.delta_t_k = set_delta_t_k;
  out.delta_t_se_k = 0.002 * set_delta_t_k;
  out.fit.verdict = FitVerdict::ok;
  out.fit.threshold = s75_mrad;
  out.fit.slope = 3;
  out.fit.ci95 = {s75_mrad * std::exp(-half_width_percent / 100), s75_mrad * std::exp(half_width_percent / 100)};
  return out;
}

TodCurve curve_of_two() {
  return {.observer = "hvs-1", .sensor = "s", .points = {point(16.9, 2, 1.2), point(0.5, 3, 4)}};
}

double seconds_of(const AccuracyBill& bill, std::string_view part) {
  for (const BillRow& row : bill.rows) {
    if (row.part.starts_with(part)) return row.seconds.value_or(NAN);
  }
  return NAN;
}

std::string all_sentences(const AccuracyBill& bill) {
  std::string text;
  for (const std::string& sentence : bill.sentences) text += sentence + "\n";
  return text;
}

TEST(AccuracyBill, StatesTheTimeOfTheTwinBesideThatOfTheRun) {
  const auto presentations = run_of_twelve();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;

  const AccuracyBill alone =
      accuracy_bill({.presentations = presentations, .curve = curve, .effects = effects, .wall_s = 60});
  const AccuracyBill both =
      accuracy_bill({.presentations = presentations, .curve = curve, .effects = effects, .wall_s = 60, .twin_s = 46.1});

  EXPECT_THAT(all_sentences(alone), Not(HasSubstr("twin")));
  EXPECT_THAT(all_sentences(both), HasSubstr("The simulation of the twin took 46 s after the run."));
  EXPECT_NEAR(both.total_s, 60, 0);
}

TEST(AccuracyBill, DividesTheTimeOfARunWithoutARest) {
  const auto presentations = run_of_twelve();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;

  const AccuracyBill bill =
      accuracy_bill({.presentations = presentations, .curve = curve, .effects = effects, .wall_s = 60});

  EXPECT_NEAR(seconds_of(bill, "Changes"), 24, 1e-6);
  // The last presentation has no recorded end and counts as the others of its contrast.
  EXPECT_NEAR(seconds_of(bill, "Location"), 16, 1e-6);
  EXPECT_NEAR(seconds_of(bill, "Presentations at 16.9 K"), 6, 1e-6);
  EXPECT_NEAR(seconds_of(bill, "Presentations at 0.5 K"), 6, 1e-6);
  EXPECT_NEAR(seconds_of(bill, "Rest"), 8, 1e-6);
  EXPECT_NEAR(bill.total_s, 60, 0);
  EXPECT_THAT(bill.rows[2].bought, HasSubstr("± 1.2 % (95 %), 6 presentations"));
  EXPECT_THAT(bill.rows[1].bought, HasSubstr("0.20 %"));
}

TEST(AccuracyBill, SeparatesTheLocationIfEveryPresentationOpensAContrast) {
  auto presentations = run_of_twelve();
  std::erase_if(presentations, [](const Presentation& shown) { return shown.presentation % 3 != 0; });
  for (std::size_t i = 0; i < presentations.size(); ++i)
    presentations[i].host_time_ns = std::llround((100.0 + 7.0 * static_cast<double>(i)) * 1e9);  // 2 s of change, 5 s
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;
  // 1 s for each of the 2 presentations at a contrast.
  const TimeForecast forecast{.total_s = 20, .parts_s = {{presentations_part(16.9), 2}, {presentations_part(0.5), 2}}};
  BillInput input{.presentations = presentations, .curve = curve, .effects = effects, .wall_s = 60};

  const AccuracyBill alone = accuracy_bill(input);
  input.forecast = &forecast;
  const AccuracyBill bill = accuracy_bill(input);

  // 3 of the 4 presentations have a recorded end.
  EXPECT_NEAR(seconds_of(bill, "Location"), 12, 1e-6);
  EXPECT_NEAR(seconds_of(bill, "Presentations at 16.9 K"), 2, 1e-6);
  EXPECT_NEAR(seconds_of(bill, "Presentations at 0.5 K"), 2, 1e-6);
  EXPECT_TRUE(std::isnan(seconds_of(alone, "Location")));
  EXPECT_NEAR(seconds_of(alone, "Presentations at 16.9 K"), 10, 1e-6);
}

TEST(AccuracyBill, SeparatesThePhysicalMeasuresFromTheRest) {
  auto presentations = run_of_twelve();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;
  const auto bill_of_run = [&] {
    return accuracy_bill({.presentations = presentations,
                          .curve = curve,
                          .effects = effects,
                          .wall_s = 60,
                          .measures_s = 5,
                          .quantities = 7});
  };

  const AccuracyBill bill = bill_of_run();
  for (Presentation& shown : presentations) shown.host_time_ns.reset();
  const AccuracyBill simulated = bill_of_run();

  EXPECT_EQ(seconds_of(bill, measures_part), 5);
  EXPECT_THAT(bill.rows[bill.rows.size() - 2].bought, HasSubstr("7 quantities"));
  EXPECT_NEAR(seconds_of(bill, "Rest"), 3, 1e-6);
  EXPECT_EQ(seconds_of(simulated, measures_part), 5);
  EXPECT_EQ(seconds_of(simulated, "Computing"), 55);
}

TEST(AccuracyBill, PutsTheForecastBesideTheOutcome) {
  const auto presentations = run_of_twelve();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;
  AccuracyBill forecast;
  EXPECT_FALSE(time_forecast(forecast));
  forecast.total_s = 50;
  forecast.rows = {{std::string(changes_part), 25, ""}, {presentations_part(16.9), 5, ""}, {"Another part", 3, ""}};
  const auto times = time_forecast(forecast);
  ASSERT_TRUE(times);
  BillInput input{.presentations = presentations, .curve = curve, .effects = effects, .wall_s = 60};

  const AccuracyBill alone = accuracy_bill(input);
  input.forecast = &*times;
  const AccuracyBill bill = accuracy_bill(input);

  EXPECT_EQ(forecast_and_outcome(alone), "");
  EXPECT_FALSE(bill_json(alone).contains("forecast_s"));
  EXPECT_EQ(bill_json(bill)["forecast_s"], 50);
  EXPECT_EQ(forecast_and_outcome(bill),
            "forecast of the plan and outcome of the run: 50.0 s without computing, and 60.0 s (1.2 times); Changes of "
            "the target: 25.0 s, and 24.0 s; Presentations at 16.9 K: 5.00 s, and 6.00 s");
}

TEST(AccuracyBill, HasAColumnOfTheForecastInTheReport) {
  const auto presentations = run_of_twelve();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;
  const TimeForecast forecast{.total_s = 50, .parts_s = {{std::string(changes_part), 25}}};
  BillInput input{.presentations = presentations, .curve = curve, .effects = effects, .wall_s = 60};
  const auto table_of = [&] { return std::get<Table>(bill_section(accuracy_bill(input)).blocks.front()); };

  const Table alone = table_of();
  input.forecast = &forecast;
  const Table beside = table_of();

  EXPECT_EQ(alone.header.size(), 3u);
  EXPECT_EQ(alone.rows.front().size(), 3u);
  EXPECT_THAT(beside.header, ElementsAre("Part", "Time (s)", "Forecast (s)", "Result"));
  for (const auto& row : beside.rows) EXPECT_EQ(row.size(), 4u);
}

TEST(AccuracyBill, OfASimulatedSceneIsComputing) {
  auto presentations = run_of_twelve();
  for (Presentation& shown : presentations) shown.host_time_ns.reset();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;

  const AccuracyBill bill =
      accuracy_bill({.presentations = presentations, .curve = curve, .effects = effects, .wall_s = 7});

  EXPECT_NEAR(seconds_of(bill, "Computing"), 7, 0);
  EXPECT_TRUE(std::isnan(seconds_of(bill, "Presentations at 16.9 K")));
}

TEST(AccuracyBill, SaysWhatNoPresentationReducesAndWhatTheDecisionNeeds) {
  const auto presentations = run_of_twelve();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;
  CurveUncertainty uncertainty;
  PointUncertainty low;
  low.set_delta_t_k = 0.5;
  low.statistical_mrad = curve.points[1].fit.ci95;
  low.rows.resize(2);
  low.rows[0].contribution = 0.01;
  low.rows[1].contribution = 0.02;
  low.rows[1].from_run = true;
  uncertainty.points = {low};
  Verdict verdict;
  const auto acuity = [](double delta_t_k, double limit, double result, VerdictKind decision) {
    return Demand{
        .kind = DemandKind::acuity, .delta_t_k = delta_t_k, .limit = limit, .result = result, .decision = decision};
  };
  verdict.demands = {acuity(16.9, 0.4, 0.5, VerdictKind::pass), acuity(0.5, 0.3175, 1 / 3.0, VerdictKind::pass),
                     acuity(0.5, 0.33, 1 / 3.0, VerdictKind::inconclusive)};

  const std::string text = all_sentences(accuracy_bill({.presentations = presentations,
                                                        .curve = curve,
                                                        .uncertainty = &uncertainty,
                                                        .verdict = &verdict,
                                                        .effects = effects,
                                                        .wall_s = 60}));

  EXPECT_THAT(text, HasSubstr("At 0.5 K the stated rows of the budget make ± 2.0 %, which no presentation reduces; the "
                              "trials make ± 4.1 %"));
  // Of the row of 5.9 % in ln acuity the forecast states 6.1 %, too.
  uncertainty.points[0].rows[0].contribution = 0.03;
  EXPECT_THAT(all_sentences(accuracy_bill(
                  {.presentations = presentations, .curve = curve, .uncertainty = &uncertainty, .effects = effects})),
              HasSubstr("At 0.5 K the stated rows of the budget make ± 6.1 %"));
  // A margin of 22 % needs far less than the 1.2 % that was measured: one presentation of each set-up.
  EXPECT_THAT(text, HasSubstr("the acuity at 16.9 K needs about 2 of the 6 presentations"));
  // ln(0.3333 / 0.3175) = 4.87 %, less the budget 4.46 %: (4 / 4.46)^2 = 0.80 of 6.
  EXPECT_THAT(text, HasSubstr("the acuity at 0.5 K needs about 5 of the 6 presentations"));
  EXPECT_THAT(text,
              HasSubstr("No number of presentations decides on the acuity at 0.5 K: it is 1.0 % from its limit; the "
                        "stated rows of the budget make ± 2.0 %"));
  EXPECT_THAT(text, Not(HasSubstr("would have taken"))) << "one decision is open";
  EXPECT_THAT(text, HasSubstr("leaves out no effect"));
}

TEST(AccuracyBill, StatesTheTimeOfDecisionsAndWhatAnOpenOneNeeds) {
  const auto presentations = run_of_twelve();
  TodCurve curve = curve_of_two();
  const SensorPlan effects;
  Verdict verdict;
  verdict.demands = {{.kind = DemandKind::acuity,
                      .delta_t_k = 16.9,
                      .limit = 0.5 / 1.0149,  // 1.48 %: (1.2 / 1.48)^2 = 0.66 of 6
                      .result = 0.5,
                      .decision = VerdictKind::pass}};
  const auto text = [&] {
    return all_sentences(accuracy_bill(
        {.presentations = presentations, .curve = curve, .verdict = &verdict, .effects = effects, .wall_s = 60}));
  };

  // Changes 24 s and location 16 s; of 16.9 K 0.66 of 6 s and of the 8 s for four shifts, of 0.5 K nothing and no
  // shift.
  EXPECT_THAT(text(), HasSubstr("have taken about 33 s of the 52 s for changes, location and presentations."));
  verdict.demands[0].decision = VerdictKind::inconclusive;
  verdict.demands[0].limit = 0.5 / 1.006;
  EXPECT_THAT(text(),
              HasSubstr("The open decision on the acuity at 16.9 K needs about 25 presentations in place of 6"));
  // The measured contrast alone makes 0.7 %.
  curve.points[0].fit.contrast_u = 0.007 / 1.96;
  EXPECT_THAT(text(), HasSubstr("No number of presentations decides on the acuity at 16.9 K"));
  EXPECT_THAT(text(), HasSubstr("which more frames of the contrast ([measurement] contrast_frames) reduce"));
}

TEST(AccuracyBill, NeedsAsManyPresentationsAsGradedAnswersDo) {
  std::vector<Presentation> presentations;
  for (const Presentation& one : run_of_twelve()) presentations.insert(presentations.end(), 4, one);
  TodCurve curve = curve_of_two();
  curve.points[0].fit.interval = IntervalKind::set_ups;
  const SensorPlan effects;
  Verdict verdict;
  verdict.demands = {
      {.kind = DemandKind::acuity, .delta_t_k = 16.9, .limit = 0.4, .result = 0.5, .decision = VerdictKind::pass}};

  EXPECT_THAT(
      all_sentences(accuracy_bill(
          {.presentations = presentations, .curve = curve, .verdict = &verdict, .effects = effects, .wall_s = 60})),
      HasSubstr("needs about 8 of the 24 presentations"));
}

TEST(AccuracyBill, SaysSoWithoutABudgetAndWithoutALimit) {
  const auto presentations = run_of_twelve();
  const TodCurve curve = curve_of_two();
  const SensorPlan effects;
  const Verdict verdict;

  const AccuracyBill bill = accuracy_bill(
      {.presentations = presentations, .curve = curve, .verdict = &verdict, .effects = effects, .wall_s = 60});

  EXPECT_THAT(bill.sentences, ElementsAre(std::string(no_budget_sentence), std::string(no_limit_sentence),
                                          "The simulation leaves out no effect that changes the acuity."));
}

TEST(AccuracyBill, NamesTheEffectsThatWereLeftOutWithTheReasonOfEach) {
  const SensorPlan effects{.decisions = {{Effect::quantisation, Decision::skip, "below the tolerance", 0.3},
                                         {Effect::temporal_noise, Decision::skip, "below the tolerance", 0.064},
                                         {Effect::distortion, Decision::skip, "neutral", 0.0},
                                         {Effect::display, Decision::skip, "skipped on request; predicted", 4.21, true},
                                         {Effect::diffraction, Decision::simulate, "always", {}}}};

  EXPECT_THAT(left_out_sentences(effects),
              ElementsAre("The simulation leaves out, because the change of the acuity is below the tolerance: "
                          "quantisation (at most 0.30 %), temporal noise (at most 0.064 %).",
                          "The simulation leaves out on request: display (predicted change 4.2 %).",
                          "Not in this sensor or scene, and therefore without a change: distortion."));
}

TEST(AccuracyBill, NamesAnEffectSkippedOnRequestWithoutABound) {
  const SensorPlan effects = full_plan(SensorSpec{}, {Effect::detector}, {});

  const auto sentences = left_out_sentences(effects);

  ASSERT_FALSE(sentences.empty());
  EXPECT_EQ(sentences[0], "The simulation leaves out on request: detector (the change is not bounded).");
}

}  // namespace
}  // namespace todbench
