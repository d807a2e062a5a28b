// SPDX-License-Identifier: GPL-3.0-or-later
// Range models side by side, and the air by name.
#include "bench/range/range_models.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bench/plan/bench_air.h"
#include "bench/range/turbulent_ranges.h"
#include "bench/report/grid_figure.h"
#include "bench/report/html.h"
#include "bench/report/range_figure.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

const std::vector<TodThreshold> tod{{0.2, 6, {5, 7}}, {1, 2, {1.9, 2.1}}, {10, 1.5, {1.4, 1.6}}};

RangeQuestion question(const std::string& atmosphere) {
  RangeQuestion asked{.size_m = 4.9, .delta_t_k = 3};
  const auto air = load_atmosphere(atmosphere, {});
  EXPECT_TRUE(air) << air.error().message;
  asked.air = *air;
  return asked;
}

RangeSources sources() {
  SensorSpec sensor;
  sensor.name = "sc2000";
  return {.thresholds = tod, .sensor = sensor};
}

TEST(RangeModels, AnswerSideBySideEachWithItsCriterionAndLimit) {
  const auto models = range_models(all_range_models, sources(), question("us-standard"));

  ASSERT_TRUE(models) << models.error().message;
  ASSERT_EQ(models->size(), 4u);
  for (const auto& model : *models) {
    ASSERT_TRUE(model.r75_m) << model.name << ": " << model.reason;
    EXPECT_GT(*model.r50_m, *model.r75_m);
    EXPECT_TRUE(model.dominant());
    EXPECT_FALSE(model.criterion.empty());
    EXPECT_FALSE(model.curve.empty());
  }
}

TEST(RangeModels, TodInClearAirIsTheRangeOfTheTodCurve) {
  const auto models = range_models(std::array{RangeModel::tod}, sources(), question("clear"));
  const auto plain = predict_range(tod, {.size_m = 4.9, .delta_t_k = 3});

  ASSERT_TRUE(models && plain);
  EXPECT_EQ(models->front().r75_m, plain->r75_m);
  EXPECT_EQ(models->front().r75_ci95_m.low, plain->r75_ci95_m.low);
}

TEST(RangeModels, TheRangeOnTheAsymptoteHasTheUncertaintyOfM75InFull) {
  // Above the highest contrast the acuity is constant, so that in clear air R75 is proportional to 1 / M75.
  RangeQuestion exact = question("clear"), stated = exact;
  exact.delta_t_k = stated.delta_t_k = 30;
  stated.m75_u_percent = 8;

  const auto without = range_models(std::array{RangeModel::tod}, sources(), exact);
  const auto with = range_models(std::array{RangeModel::tod}, sources(), stated);

  ASSERT_TRUE(without && with);
  const double r75_m = *with->front().r75_m, reach = 1.959963984540054 * 0.08;
  EXPECT_EQ(r75_m, *without->front().r75_m);
  const double low = std::log(r75_m / *without->front().r75_ci95_m.low);
  const double high = std::log(*without->front().r75_ci95_m.high / r75_m);
  EXPECT_NEAR(std::log(r75_m / *with->front().r75_ci95_m.low), std::hypot(low, reach), 1e-6);
  EXPECT_NEAR(std::log(*with->front().r75_ci95_m.high / r75_m), std::hypot(high, reach), 1e-6);
}

TEST(RangeModels, NameTheObserversOfCurveAndCriterionIfTheyDiffer) {
  RangeQuestion asked = question("clear");
  EXPECT_EQ(observers_differ(asked), "");
  asked.curve_observer = "human";
  EXPECT_EQ(observers_differ(asked), "");

  asked.curve_observer = "hvs-1";

  EXPECT_THAT(observers_differ(asked), HasSubstr("judged by hvs-1"));
  EXPECT_THAT(criterion_origin(asked, RangeModel::tod), HasSubstr("people, small craft"));
  EXPECT_THAT(criterion_origin(asked, RangeModel::ttp), HasSubstr("V50 = 8.5"));
  const auto models = range_models(std::array{RangeModel::tod, RangeModel::ttp}, sources(), asked);
  ASSERT_TRUE(models);
  EXPECT_THAT(models->front().notes, ::testing::Contains(HasSubstr("hvs-1")));
  // 3 K over twice 10 K.
  EXPECT_THAT(models->back().display, HasSubstr("0.15 before the air"));
  asked.criterion_source = CriterionSource::m75_stated;
  EXPECT_EQ(observers_differ(asked), "");
}

TEST(RangeModels, TheTransferredTodCurveReplacesTheMtdpLikeCurve) {
  RangeSources with = sources();
  with.transfer = tod_transfers().front();
  RangeQuestion asked = question("clear");
  asked.delta_t_k = 30;
  asked.curve_observer = "hvs-1";
  const auto models = range_models(std::array{RangeModel::mtdp}, with, asked);

  ASSERT_TRUE(models) << models.error().message;
  const ModelRange& mtdp = models->front();
  ASSERT_TRUE(mtdp.r75_m) << mtdp.reason;
  // 10 K is the highest contrast: S75 = 1.5 mrad, 1.4 to 1.6. Johnson's x for 75 % is 1.3516.
  const double frequency = transfer_factor(*with.transfer, 1) / 1.5;
  EXPECT_NEAR(*mtdp.r75_m / (1000 * 4.9 * frequency / (6 * 1.3516)), 1, 1e-4);
  EXPECT_NEAR(std::log(*mtdp.r75_ci95_m.high / *mtdp.r75_m),
              std::hypot(std::log(1.5 / 1.4), with.transfer->half_width_ln), 1e-4);
  EXPECT_THAT(mtdp.reads, HasSubstr("simulated-imagers-1"));
  const auto nominal = nominal_ranges(with, asked);
  ASSERT_TRUE(nominal && nominal->identification_m);
  EXPECT_GT(*nominal->detection_m, *nominal->identification_m);
  EXPECT_LE(*nominal->identification_m, 1000 * 2.3 * frequency / 6) << "air reduces the contrast";
}

TEST(RangeModels, TheTransferRefusesOtherObserversAndSamplings) {
  RangeSources with = sources();
  with.transfer = tod_transfers().front();
  RangeQuestion asked = question("clear");
  const auto reason = [&] { return range_models(std::array{RangeModel::mtdp}, with, asked).value().front().reason; };
  asked.curve_observer = "human";
  EXPECT_THAT(reason(), HasSubstr("judged by human"));
  asked.curve_observer = "hvs-1";
  with.sensor->microscan = 2;
  EXPECT_THAT(reason(), HasSubstr("more than one sample"));
  with.sensor.reset();
  EXPECT_THAT(reason(), HasSubstr("no sensor"));
}

TEST(RangeGrid, IsEveryModelAtEveryTargetOnItsOwn) {
  const RangeGridAxes axes{.sizes_m = {2, 4.9}, .contrasts_k = {1, 30}, .ranges_m = {200, 700}};

  const auto grids = range_grid(all_range_models, sources(), question("us-standard"), axes);

  ASSERT_TRUE(grids) << grids.error().message;
  ASSERT_EQ(grids->size(), all_range_models.size());
  for (std::size_t i = 0; i < axes.sizes_m.size(); ++i) {
    for (std::size_t k = 0; k < axes.contrasts_k.size(); ++k) {
      RangeQuestion one = question("us-standard");
      one.size_m = axes.sizes_m[i];
      one.delta_t_k = axes.contrasts_k[k];
      const auto alone = range_models(all_range_models, sources(), one);
      ASSERT_TRUE(alone);
      for (std::size_t m = 0; m < grids->size(); ++m) {
        const std::size_t at = i * axes.contrasts_k.size() + k;
        ASSERT_EQ((*grids)[m].r75_m[at].has_value(), (*alone)[m].r75_m.has_value());
        if ((*alone)[m].r75_m) {
          EXPECT_NEAR(*(*grids)[m].r75_m[at] / *(*alone)[m].r75_m, 1, 1e-9) << m;
        }
        const auto near = (*grids)[m].probability[at * 2], far = (*grids)[m].probability[at * 2 + 1];
        ASSERT_TRUE(near);
        if (far) {
          EXPECT_LT(*far, *near);
        }
        if (const auto r75_m = (*alone)[m].r75_m) {
          EXPECT_EQ(*near > 0.75, *r75_m > 200);
        }
      }
    }
  }
}

TEST(RangeGrid, RefusesWhatIsNone) {
  const auto asked = question("clear");
  const std::vector<double> many(500, 1.0);
  for (const RangeGridAxes& axes :
       {RangeGridAxes{{}, {1}, {}}, RangeGridAxes{{1}, {}, {}}, RangeGridAxes{{1}, {0}, {}},
        RangeGridAxes{{-1}, {1}, {}}, RangeGridAxes{{1}, {1}, {0}}, RangeGridAxes{many, many, {}}}) {
    EXPECT_FALSE(range_grid(all_range_models, sources(), asked, axes));
  }
}

// MRTD a exp(b f), no air: R75 = size ln(C / a) / (b N75), so a threshold u higher shortens it by ln u / ln(C / a).
TEST(RangeModels, TheUncertaintyOfACurveJoinsTheInterval) {
  RangeSources given;
  std::vector<CurvePoint> points;
  for (int i = 0; i <= 10; ++i) points.push_back({0.3 * i, 0.01 * std::exp(1.8 * i)});
  given.mrtd = *LogLinearCurve::of(points, "MRTD");
  RangeQuestion asked = question("clear");
  asked.curve_u_percent = 10;

  const auto models = range_models(std::array{RangeModel::acquire}, given, asked);

  ASSERT_TRUE(models && models->front().r75_m);
  const double change = 1.959963984540054 * 0.1 / std::log(3 / 0.01);
  EXPECT_NEAR(*models->front().r75_ci95_m.low / *models->front().r75_m, 1 - change, 1e-6);
  EXPECT_NEAR(*models->front().r75_ci95_m.high / *models->front().r75_m, 1 + change, 1e-6);
}

TEST(RangeModels, TheBudgetOfASessionJoinsTheIntervalsOfFormulas) {
  RangeSources given;
  std::vector<CurvePoint> points;
  for (int i = 0; i <= 10; ++i) points.push_back({0.3 * i, 0.01 * std::exp(1.8 * i)});
  given.mrtd = *LogLinearCurve::of(points, "MRTD");
  RangeQuestion kelvin = question("clear"), angle = question("clear"), both = question("clear");
  kelvin.scale_u_percent = both.scale_u_percent = 3;
  kelvin.curve_u_percent = both.curve_u_percent = 4;
  angle.ifov_u_percent = both.ifov_u_percent = 2;
  const auto half_of = [&](const RangeQuestion& asked) {
    const auto models = range_models(std::array{RangeModel::acquire}, given, asked);
    EXPECT_TRUE(models && models->front().r75_m);
    EXPECT_THAT(models->front().notes, ::testing::SizeIs(1));
    return std::log(*models->front().r75_m / *models->front().r75_ci95_m.low);
  };

  // As the uncertainty of the curve, 3 and 4 % in quadrature; the angle as it is.
  const double of_kelvin = -std::log(1 - 1.959963984540054 * 0.05 / std::log(3 / 0.01));
  const double of_angle = 1.959963984540054 * 0.02;
  EXPECT_NEAR(half_of(kelvin), of_kelvin, 1e-6);
  EXPECT_NEAR(half_of(angle), of_angle, 1e-9);
  EXPECT_NEAR(half_of(both), std::hypot(of_kelvin, of_angle), 1e-6);
}

TEST(GridFigure, HasALineForEachSizeAndEndsWhereNothingIsKnown) {
  const GridFigure grid{.model = "tod",
                        .sizes_m = {5, 2},
                        .contrasts_k = {4, 1, 10},
                        .r75_m = {900.0, 400.0, 1200.0, 300.0, std::nullopt, 450.0}};

  const auto plot = grid_plot(grid);

  ASSERT_TRUE(plot);
  ASSERT_EQ(plot->series.size(), 2u);
  EXPECT_EQ(plot->series[0].label, "5 m");
  ASSERT_EQ(plot->series[0].points.size(), 3u);
  EXPECT_EQ(plot->series[0].points[0].x, 1);
  EXPECT_EQ(plot->series[0].points[2].y, 1200);
  EXPECT_FALSE(plot->series[1].points[0].y);
  EXPECT_TRUE(drawn(*plot));
  GridFigure none = grid;
  for (auto& r75 : none.r75_m) r75.reset();
  EXPECT_FALSE(grid_plot(none));
}

// A target of three times the display's contrast behind air that leaves a third of it looks as one of contrast 1 in
// clear air, not as one of a third.
TEST(RangeModels, TheTtpCutsTheContrastBehindTheAir) {
  RangeQuestion bright = question("clear"), dim = bright;
  bright.target_contrast = 3;
  dim.target_contrast = 1;
  const auto clear = range_models(std::array{RangeModel::ttp}, sources(), dim);
  ASSERT_TRUE(clear && clear->front().r75_m);
  const double range_km = *clear->front().r75_m / 1000;
  bright.air.air = Transmittance::beer_lambert(std::log(3.0) / range_km);

  const auto hazy = range_models(std::array{RangeModel::ttp}, sources(), bright);

  ASSERT_TRUE(hazy && hazy->front().r75_m);
  EXPECT_NEAR(*hazy->front().r75_m / *clear->front().r75_m, 1, 1e-6);
}

TEST(RangeModels, TheFormOfPChangesTheTtpRange) {
  const auto asked = question("clear");
  const auto first = ttp_ranges(sources(), asked, ProbabilityForm::ttp_2004);
  const auto second = ttp_ranges(sources(), asked, ProbabilityForm::fixed_1_5);

  // Without air V goes with 1 / R, so the ranges are as the x of the forms: 1.7650 and 2.0801.
  EXPECT_NEAR(*first.r75_m / *second.r75_m, 2.0801 / 1.7650, 1e-4);
  EXPECT_EQ(first.r50_m, second.r50_m);
}

TEST(RangeModels, UncertainAirWidensTheInterval) {
  auto asked = question("tropical");
  const auto certain = range_models(std::array{RangeModel::tod}, sources(), asked);
  asked.extinction_u_percent = 20;
  const auto uncertain = range_models(std::array{RangeModel::tod}, sources(), asked);

  ASSERT_TRUE(certain && uncertain);
  EXPECT_EQ(certain->front().r75_m, uncertain->front().r75_m);
  EXPECT_LT(*uncertain->front().r75_ci95_m.low, *certain->front().r75_ci95_m.low);
  EXPECT_GT(*uncertain->front().r75_ci95_m.high, *certain->front().r75_ci95_m.high);
}

TEST(RangeModels, WithoutSensorOrCurveSayWhy) {
  const auto models = range_models(all_range_models, {.thresholds = {}}, question("clear"));

  ASSERT_TRUE(models);
  for (const auto& model : *models) {
    EXPECT_FALSE(model.r75_m);
    EXPECT_FALSE(model.reason.empty()) << model.name;
  }
}

// A curve a exp(b f) behind turbulence is a exp(b f + c (R) f^(5/3)): its range solved here on its own.
TEST(TurbulentRanges, OfAnExponentialCurveSolveTheClosedForm) {
  constexpr double a = 0.01, b = 1.1, cn2 = 1e-13;
  RangeSources given = sources();
  std::vector<CurvePoint> points;
  for (int i = 0; i <= 600; ++i) points.push_back({0.01 * i, a * std::exp(b * 0.01 * i)});
  given.mrtd = *LogLinearCurve::of(points, "MRTD");
  const auto asked = question("clear");
  const auto still = range_models(std::array{RangeModel::acquire}, given, asked);
  ASSERT_TRUE(still && still->front().r75_m);
  const double still_m = *still->front().r75_m;
  const auto behind = TurbulentSources::of(given, std::nullopt, cn2, 2.2 * *still->front().r50_m);
  ASSERT_TRUE(behind) << behind.error().message;

  const auto models = turbulent_range_models(std::array{RangeModel::acquire}, *behind, asked);

  ASSERT_TRUE(models && models->front().r75_m) << models->front().reason;
  const double wavelength_m = turbulent_path(behind->sensor_at(1))->wavelength_um * 1e-6;
  const double k = 2 * std::numbers::pi / wavelength_m;
  const double n75 = 6 * 1.3516;  // sheet of facts: Johnson's x for 75 %
  const auto excess = [&](double range_m) {
    const double f = n75 * range_m / 4.9;  // cycles per radian
    const double r0_m = std::pow(0.423 * k * k * cn2 * range_m * 3 / 8, -0.6);
    return std::log(a) + b * f / 1000 + 3.44 * std::pow(wavelength_m * f / r0_m, 5.0 / 3) - std::log(3);
  };
  double low = 1, high = still_m;
  for (int i = 0; i < 100; ++i) (excess((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  EXPECT_LT(low, 0.97 * still_m) << "the case is one in which turbulence matters";
  // Four digits of x; the curve is linear between points 0.01 apart.
  EXPECT_NEAR(*models->front().r75_m / low, 1, 1e-4);
  const auto& curve = models->front().curve;
  ASSERT_GT(curve.size(), 20u);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (!curve[i].probability) continue;
    EXPECT_LE(*curve[i].probability, *curve[i - 1].probability);
    EXPECT_EQ(*curve[i].probability > 0.75 + 2e-3, curve[i].range_m < low * (1 - 2e-3)) << curve[i].range_m;
  }
}

TEST(TurbulentRanges, LeaveTheTodRangeAsItIsWhereTheyCannotMatter) {
  const auto asked = question("us-standard");
  const RangeTask task{.size_m = asked.size_m, .delta_t_k = asked.delta_t_k, .air = asked.air.air};
  const auto still = predict_range(tod, task);
  ASSERT_TRUE(still && still->r75_m);
  const SensorSpec sensor = *sources().sensor;

  const auto weak = decide_turbulence(sensor, 1e-15, asked, still->r75_m, 1);
  const auto strong = decide_turbulence(sensor, 1e-11, asked, still->r75_m, 1);
  const auto behind = TurbulentSources::of(sources(), std::nullopt, 1e-15, 3 * *still->r75_m);

  EXPECT_FALSE(weak.simulated) << weak.reason;
  EXPECT_TRUE(strong.simulated) << strong.reason;
  ASSERT_TRUE(behind);
  const auto models = turbulent_range_models(std::array{RangeModel::tod}, *behind, asked);
  ASSERT_TRUE(models);
  EXPECT_EQ(models->front().r75_m, still->r75_m);
}

TEST(TurbulentRanges, OfTheTodCurveMeetTheCriterionBehindTheirOwnPath) {
  const auto asked = question("clear");
  const RangeTask task{.size_m = asked.size_m, .delta_t_k = asked.delta_t_k};
  const auto still = predict_range(tod, task);
  ASSERT_TRUE(still && still->r75_ci95_m.high);
  const auto behind = TurbulentSources::of(sources(), TemplateObserverSpec{}, 1e-11, 2.2 * *still->r75_ci95_m.high);
  ASSERT_TRUE(behind) << behind.error().message;

  const auto prediction = turbulent_prediction(*behind, tod, task);

  ASSERT_TRUE(prediction && prediction->r75_m) << prediction->reason;
  EXPECT_LT(*prediction->r75_m, *still->r75_m);
  // By the bound of the planner at the range without it, which is further.
  const double most = decide_turbulence(*sources().sensor, 1e-11, asked, still->r75_m, 1).bound_percent;
  EXPECT_GT(*prediction->r75_m, *still->r75_m / (1 + most / 100));
  const auto point = range_point(behind->thresholds_at(tod, *prediction->r75_m), task, *prediction->r75_m);
  ASSERT_TRUE(point && point->probability);
  EXPECT_NEAR(*point->probability, 0.75, 1e-5);
  EXPECT_LT(*prediction->r75_ci95_m.low, *prediction->r75_m);
  EXPECT_GT(*prediction->r75_ci95_m.high, *prediction->r75_m);
}

TEST(TurbulentRanges, RefuseWhatIsNone) {
  RangeSources without = sources();
  without.sensor.reset();

  EXPECT_FALSE(TurbulentSources::of(without, std::nullopt, 1e-14, 1000));
  EXPECT_FALSE(TurbulentSources::of(sources(), std::nullopt, 0, 1000));
  EXPECT_FALSE(TurbulentSources::of(sources(), std::nullopt, 1e-14, 0));
}

TEST(RangePage, HasTheFigureAndEveryModel) {
  const auto models = range_models(all_range_models, sources(), question("midlatitude-summer"));
  ASSERT_TRUE(models);

  const auto svg = range_svg(*models);
  const std::string page = render_html(range_page(*models, {.target = "4.9 m", .air = "some", .notes = {}}));

  ASSERT_TRUE(svg) << svg.error().message;
  EXPECT_THAT(*svg, HasSubstr("ACQUIRE"));
  for (const char* word : {"TOD", "ACQUIRE", "TTP", "MTDP-like", "<svg"}) EXPECT_THAT(page, HasSubstr(word));
  EXPECT_FALSE(range_svg(std::vector<ModelRange>{}));
}

TEST(RangePage, StatesTheSpreadOfAnObserverWithAnEye) {
  RangeSources seen = sources();
  for (TodThreshold& one : seen.thresholds) one.s75_spread_mrad = {0.5 * one.s75_mrad, 2 * one.s75_mrad};

  const auto models = range_models(all_range_models, seen, question("clear"));
  ASSERT_TRUE(models) << models.error().message;
  const ModelRange& tod_model = models->front();
  ASSERT_TRUE(tod_model.r75_spread_m);
  EXPECT_NEAR(tod_model.r75_spread_m->first, 0.5 * *tod_model.r75_m, 1e-9);
  EXPECT_NEAR(tod_model.r75_spread_m->second, 2 * *tod_model.r75_m, 1e-9);
  const std::string page = render_html(range_page(*models, {.target = "4.9 m", .air = "some", .notes = {}}));
  EXPECT_THAT(page, HasSubstr("over the open parameters of the observer (no confidence interval)"));
}

TEST(Atmospheres, OfTheShippedTableAreThoseOfTheSheetOfFacts) {
  struct Row {
    const char* name;
    double at_1_km, at_5_km;
  };
  // Three decimals, rural aerosol of 23 km, 7.5-13 um.
  for (const auto& [name, at_1_km, at_5_km] :
       {Row{"tropical", 0.546, 0.124}, Row{"midlatitude-summer", 0.644, 0.237}, Row{"us-standard", 0.798, 0.535},
        Row{"midlatitude-winter", 0.842, 0.628}, Row{"subarctic-winter", 0.895, 0.743}}) {
    const auto air = load_atmosphere(name, {});
    ASSERT_TRUE(air) << air.error().message;
    EXPECT_NEAR(air->air.at(1000).value(), at_1_km, 6e-4) << name;
    EXPECT_NEAR(air->air.at(5000).value(), at_5_km, 6e-4) << name;
  }
}

TEST(BenchAir, OfTheHumidityOfAModelAtmosphereIsThatOfItsTable) {
  // Midlatitude summer at the ground: 294.2 K, 14 g/m3 (Anderson et al. 1986); saturation after Magnus 18.4 g/m3.
  BenchAir summer{.temperature_c = 294.2 - 273.15, .humidity_percent = 100};
  summer.humidity_percent = 100 * 14.0 / absolute_humidity_g_m3(summer);
  const auto table = load_atmosphere("midlatitude-summer", {.haze = "none"});
  ASSERT_TRUE(table);
  for (const double length_m : {1.0, 2.0, 5.0}) {
    const auto found = bench_transmittance(summer, length_m, {7.5, 13});
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_NEAR(*found, table->air.at(length_m).value(), 1e-12) << length_m;
  }
  // The sheet of facts: 0.3 to 1.2 % of contrast over 2 m, less than half of it from 8 to 12 um.
  const auto dry = bench_transmittance({.temperature_c = 5, .humidity_percent = 20}, 2, {7.5, 13});
  const auto humid = bench_transmittance({.temperature_c = 30, .humidity_percent = 63}, 2, {7.5, 13});
  const auto narrow = bench_transmittance({.temperature_c = 30, .humidity_percent = 63}, 2, {8, 12});
  EXPECT_NEAR(1 - *dry, 0.003, 0.0005);
  EXPECT_NEAR(1 - *humid, 0.012, 0.0005);
  EXPECT_LT(1 - *narrow, (1 - *humid) / 2);
}

TEST(BenchAir, HoldsTheWaterThatTablesOfSaturationSay) {
  // 17.3 g/m3 at 20 °C, 30.4 at 30 °C: three digits, Magnus' pressure to 0.3 %, vapour as an ideal gas to 0.1 %.
  EXPECT_NEAR(absolute_humidity_g_m3({.temperature_c = 20, .humidity_percent = 100}) / 17.3, 1, 0.007);
  EXPECT_NEAR(absolute_humidity_g_m3({.temperature_c = 30, .humidity_percent = 50}) / 15.2, 1, 0.007);
}

TEST(BenchAir, RefusesWhatNoTableHas) {
  EXPECT_FALSE(bench_transmittance({.temperature_c = 50, .humidity_percent = 90}, 2, {7.5, 13})) << "75 g/m3";
  EXPECT_FALSE(bench_transmittance({}, 2, {1, 2})) << "no band near";
  EXPECT_FALSE(bench_transmittance({}, 0, {7.5, 13}));
  EXPECT_FALSE(bench_transmittance({}, 1e6, {7.5, 13}));
  EXPECT_FALSE(bench_transmittance({.temperature_c = NAN}, 2, {7.5, 13}));
}

TEST(Atmospheres, EveryShippedTableCanBeRead) {
  for (const auto& name : atmosphere_names()) {
    for (const auto& haze : haze_names()) {
      for (const SpectralBand band : {SpectralBand{7.5, 13}, {8, 12}, {8, 14}, {3, 5}}) {
        const auto air = load_atmosphere(name, {.band = band, .haze = haze});
        EXPECT_TRUE(air) << name << " " << haze << ": " << air.error().message;
      }
    }
  }
  EXPECT_FALSE(load_atmosphere("tropical", {.band = {1, 2}})) << "no band near";
  EXPECT_FALSE(load_atmosphere("tropical", {.haze = "smoke"}));
  EXPECT_FALSE(load_atmosphere("tropical", {.extinction_per_km = 1})) << "two extinctions";
  EXPECT_FALSE(load_atmosphere("clear", {.extinction_per_km = 1})) << "clear air with an extinction";
}

TEST(Atmospheres, FromFilesAreReadOrRefusedWithTheirName) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& name, const std::string& content) {
    return load_atmosphere(folder.write(name, content).string(), {});
  };

  const auto table = read("a.csv", "# mine\nrange_km,transmittance\n0.1,0.97\n1,0.8\n5,0.4\n");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_DOUBLE_EQ(table->air.at(1000).value(), 0.8);
  const auto spectrum = read("s.csv", "wavelength_um,extinction_per_km\n8,0.3\n12,0.3\n");
  ASSERT_TRUE(spectrum) << spectrum.error().message;
  EXPECT_NEAR(spectrum->air.at(2000).value(), std::exp(-0.6), 1e-12);
  for (const char* content : {"", "range_km,transmittance\n", "range_km,transmittance\n1,0.5\n0.5,0.7\n",
                              "range_km,transmittance\n1,x\n", "km,tau\n1,0.5\n", "range_km,transmittance\n1,0.5,3\n",
                              "range_km,transmittance\n-1,0.5\n2,0.4\n", "range_km,transmittance\n1,nan\n2,0.4\n"}) {
    const auto refused = read("b.csv", content);
    ASSERT_FALSE(refused) << content;
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
    EXPECT_THAT(refused.error().message, HasSubstr("b.csv"));
  }
  EXPECT_FALSE(read("tape7", "nothing of the kind\n"));
  EXPECT_FALSE(load_atmosphere("./not-there.csv", {}));
}

}  // namespace
}  // namespace todbench
