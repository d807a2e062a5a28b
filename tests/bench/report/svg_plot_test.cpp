// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/svg.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <locale>

#include "bench/report/number_format.h"
#include "bench/report/plot.h"
#include "bench/report/plot_ticks.h"
#include "bench/report/tod_figures.h"
#include "tests/bench/report/report_sample.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::vector<std::string> labels(const std::vector<Tick>& ticks) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks)
    if (!tick.label.empty()) result.push_back(tick.label);
  return result;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

/// The value of an attribute of the first element that starts with `start`.
double attribute(const std::string& text, const std::string& start, const std::string& name) {
  const std::size_t from = text.find(name + "=\"", text.find(start));
  return std::stod(text.substr(from + name.size() + 2));
}

/// A square plot from 0 to 1 without legend: x pixel = 66 + 316 x, y pixel = 14 + 336 (1 - y).
Plot unit_plot() {
  Plot plot;
  plot.id = "unit";
  plot.width = 400;
  plot.height = 400;
  plot.x.label = "x (1)";
  plot.y.label = "y (1)";
  return plot;
}

std::string svg(const Plot& plot) {
  return svg_element(*drawn(plot)).text;
}

PlotSeries one_point(const PlotPoint& point) {
  PlotSeries series;
  series.points = {point};
  return series;
}

TEST(NumberFormat, AResultIsGivenToTheDigitsOfItsInterval) {
  EXPECT_EQ(with_interval(0.48, {0.468, 0.493}), "0.480 [0.468, 0.493]");
  EXPECT_EQ(with_interval(2.0831, {1.71, 2.52}), "2.08 [1.71, 2.52]");
  EXPECT_EQ(with_interval(1234.5, {1100, 1400}), "1234 [1100, 1400]");
  EXPECT_EQ(with_interval(-0.0312, {-0.0402, -0.0201}), "−0.031 [−0.040, −0.020]");
}

TEST(NumberFormat, AnOpenSideIsSaidAndNotInvented) {
  EXPECT_EQ(with_interval(0.48, {0.468, {}}), "0.480 [≥ 0.468]");
  EXPECT_EQ(with_interval({}, {{}, 1.27}), "≤ 1.27");
  EXPECT_EQ(with_interval({}, {0.5, 1.5}), "[0.50, 1.50]");
  EXPECT_EQ(with_interval(0.48, {}), "0.480");
  EXPECT_EQ(with_interval({}, {}), "–");
}

TEST(NumberFormat, WhatIsNotFiniteBecomesADash) {
  const double infinity = std::numeric_limits<double>::infinity();

  EXPECT_EQ(fixed(std::nan(""), 2), "–");
  EXPECT_EQ(significant(-infinity, 3), "–");
  EXPECT_EQ(with_interval(infinity, {1.0, infinity}), "≥ 1.00");
  EXPECT_EQ(with_interval(std::nan(""), {-infinity, infinity}), "–");
}

TEST(NumberFormat, SignificantDigitsNeedNoExponent) {
  EXPECT_EQ(significant(16.9, 3), "16.9");
  EXPECT_EQ(significant(0.0702, 2), "0.070");
  EXPECT_EQ(significant(-0.231, 3), "−0.231");
  EXPECT_EQ(significant(0, 3), "0");
  EXPECT_EQ(fixed(-0.001, 2), "0.00");
  EXPECT_EQ(probability(0.0004), "< 0.001");
  EXPECT_EQ(stated(20), "20");
  EXPECT_EQ(stated(0.25), "0.25");
}

TEST(Acuity, TheIntervalHasItsBoundsExchanged) {
  const Interval acuity = acuity_interval(Interval{2.0, 4.0});
  const Interval open = acuity_interval(Interval{0.0, 4.0});

  EXPECT_EQ(acuity.low, 0.25);
  EXPECT_EQ(acuity.high, 0.5);
  EXPECT_EQ(open.low, 0.25);
  EXPECT_FALSE(open.high);
}

/// A locale with the decimal comma and groups of three, there on every machine.
class CommaPunctuation final : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(NumberFormat, TheLocaleDoesNotMatter) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaPunctuation));

  const std::string number = with_interval(1234.5, {1234.25, 1234.75});
  std::locale::global(before);

  EXPECT_EQ(number, "1234.50 [1234.25, 1234.75]");
}

TEST(PlotTicks, LinearStepsAreOneTwoOrFive) {
  EXPECT_THAT(labels(axis_ticks({"", AxisScale::linear, 0, 0.55, {}}, 8)),
              ElementsAre("0.0", "0.1", "0.2", "0.3", "0.4", "0.5"));
  EXPECT_THAT(labels(axis_ticks({"", AxisScale::linear, -3, 47, {}}, 6)), ElementsAre("0", "10", "20", "30", "40"));
  EXPECT_THAT(labels(axis_ticks({"", AxisScale::linear, 0, 10, {}}, 3)), ElementsAre("0", "5", "10"));
}

TEST(PlotTicks, LogarithmicTicksAreDecadesFilledWhereThereIsRoom) {
  EXPECT_THAT(labels(axis_ticks({"", AxisScale::logarithmic, 0.1, 1000, {}}, 5)),
              ElementsAre("0.1", "1", "10", "100", "1000"));
  EXPECT_THAT(labels(axis_ticks({"", AxisScale::logarithmic, 0.9, 11, {}}, 6)), ElementsAre("1", "2", "5", "10"));
  EXPECT_THAT(labels(axis_ticks({"", AxisScale::logarithmic, 1.1, 4.3, {}}, 6)), ElementsAre("1.5", "2", "3"));
}

TEST(PlotTicks, DatesAreWholeDaysWithTheirNames) {
  // 2026-11-20 is day 20777 of 1970.
  const auto month = axis_ticks({.label = "", .scale = AxisScale::dates, .low = 20777, .high = 20807, .ticks = {}}, 6);
  const auto hours =
      axis_ticks({.label = "", .scale = AxisScale::dates, .low = 20776.6, .high = 20778.3, .ticks = {}}, 8);

  ASSERT_FALSE(month.empty());
  EXPECT_LE(month.size(), 3u);
  EXPECT_EQ(month.front().value, 20780);
  EXPECT_EQ(month.front().label, "2026-11-23");
  ASSERT_EQ(hours.size(), 2u) << "half a day has no name";
  EXPECT_EQ(hours[0].label, "2026-11-20");
  EXPECT_EQ(hours[1].label, "2026-11-21");
}

TEST(PlotTicks, NoAxisHasMoreLabelsThanItHasRoomFor) {
  for (const AxisScale scale : {AxisScale::linear, AxisScale::logarithmic}) {
    for (double high = 0.011; high < 1e6; high *= 1.37) {
      const PlotAxis axis{"", scale, 0.01, high, {}};

      const std::vector<std::string> found = labels(axis_ticks(axis, 6));

      EXPECT_LE(found.size(), 6U) << high;
      EXPECT_GE(found.size(), 2U) << high;
    }
  }
}

TEST(SvgPlot, AnAxisThatCannotBeDrawnIsAnError) {
  Plot empty = unit_plot();
  empty.x.high = empty.x.low;
  Plot logarithmic = unit_plot();
  logarithmic.y = {"y (1)", AxisScale::logarithmic, 0, 1, {}};
  Plot endless = unit_plot();
  endless.x.high = std::numeric_limits<double>::infinity();

  for (const Plot& plot : {empty, logarithmic, endless}) {
    const Result<Drawing> picture = drawn(plot);
    ASSERT_FALSE(picture);
    EXPECT_EQ(picture.error().code, ErrorCode::invalid_input);
  }
}

TEST(SvgPlot, APointIsWhereItsAxesSay) {
  Plot plot = unit_plot();
  plot.series = {one_point({0.25, 0.75, {}, {}})};

  const std::string text = svg(plot);

  // 66 + 316 / 4 and 14 + 336 / 4, written to 0.01.
  EXPECT_THAT(attribute(text, "<circle", "cx"), DoubleNear(145, 0.006));
  EXPECT_THAT(attribute(text, "<circle", "cy"), DoubleNear(98, 0.006));
}

TEST(SvgPlot, ALogarithmicAxisPutsTheGeometricMeanInTheMiddle) {
  Plot plot = unit_plot();
  plot.x = {"x (1)", AxisScale::logarithmic, 0.1, 10, {}};
  plot.series = {one_point({1.0, 0.5, {}, {}})};

  const std::string text = svg(plot);

  EXPECT_THAT(attribute(text, "<circle", "cx"), DoubleNear(66 + 316 / 2.0, 0.006));
}

TEST(SvgPlot, ABoundedIntervalHasTwoCapsAndAnOpenOneAnArrowAtTheEdge) {
  Plot bounded = unit_plot();
  bounded.series = {one_point({0.5, 0.5, {0.25, 0.75}, {}})};
  Plot open = unit_plot();
  open.series = {one_point({0.5, 0.5, {0.25, {}}, {}})};

  const std::string with_caps = svg(bounded);
  const std::string with_arrow = svg(open);

  // Caps at x = 145 and 303, 5 units up and down; the arrow's point at the right edge, 382.
  EXPECT_THAT(with_caps, HasSubstr("M145.00 177.00L145.00 187.00"));
  EXPECT_THAT(with_caps, HasSubstr("M303.00 177.00L303.00 187.00"));
  EXPECT_THAT(with_arrow, HasSubstr("M145.00 177.00L145.00 187.00"));
  EXPECT_THAT(with_arrow, HasSubstr("L382.00 182.00L375.00 187.00"));
}

TEST(SvgPlot, ALimitWithoutAValueIsAnArrowWithoutAMarker) {
  Plot plot = unit_plot();
  plot.series = {one_point({{}, 0.5, {{}, 0.75}, {}})};

  const std::string text = svg(plot);

  EXPECT_THAT(text, Not(HasSubstr("<circle")));
  EXPECT_THAT(text, HasSubstr("L66.00 182.00L73.00 187.00"));
}

TEST(SvgPlot, ALineIsInterruptedWhereAValueIsMissing) {
  Plot plot = unit_plot();
  PlotSeries series;
  series.line = PlotLine::solid;
  series.points = {{0.0, 0.0, {}, {}}, {0.5, 0.5, {}, {}}, {0.6, {}, {}, {}}, {0.7, 0.7, {}, {}}, {1.0, 1.0, {}, {}}};
  plot.series = {series};

  const std::string text = svg(plot);
  const std::size_t start = text.find("d=\"", text.find("class=\"curve"));
  const std::string path = text.substr(start, text.find('"', start + 3) - start);

  EXPECT_EQ(occurrences(path, "M"), 2U);
  EXPECT_EQ(occurrences(path, "L"), 2U);
}

TEST(SvgPlot, ABandWithAnOpenSideReachesTheEdge) {
  Plot plot = unit_plot();
  plot.bands = {{"", PlotTone::first, {0.5, {}}}};

  const std::string text = svg(plot);

  EXPECT_THAT(attribute(text, "<rect class=\"band", "x"), DoubleNear(224, 0.006));
  EXPECT_THAT(attribute(text, "<rect class=\"band", "width"), DoubleNear(158, 0.006));
}

TEST(SvgPlot, LegendEntriesNeverOverlapAndStayInThePicture) {
  Plot plot = unit_plot();
  for (int i = 0; i < 7; ++i) {
    PlotSeries series;
    series.label = std::string(static_cast<std::size_t>(4 + 3 * i), 'W');
    plot.series.push_back(series);
  }

  const std::string text = svg(plot);

  std::vector<std::array<double, 3>> boxes;  // row, left, right
  const std::string start = "<text class=\"legend\"";
  for (std::size_t at = text.find(start); at != std::string::npos; at = text.find(start, at + 1)) {
    const std::string entry = text.substr(at, text.find("</text>", at) - at);
    const double x = attribute(entry, "<text", "x");
    const auto length = static_cast<double>(entry.size() - entry.find('>') - 1);
    boxes.push_back({attribute(entry, "<text", "y"), x - 40, x + 0.58 * 13 * length});
  }
  ASSERT_THAT(boxes, SizeIs(7));
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_LE(boxes[i][2], 400);
    EXPECT_LE(boxes[i][0], 400);
    for (std::size_t k = i + 1; k < boxes.size(); ++k)
      EXPECT_TRUE(boxes[i][0] != boxes[k][0] || boxes[i][2] < boxes[k][1]) << i << " and " << k;
  }
}

TEST(SvgPlot, ADocumentOfItsOwnCarriesAStyleThatEveryViewerKnows) {
  const std::array drawings{*drawn(unit_plot()), *drawn(unit_plot())};

  const std::string document = svg_document(drawings);

  EXPECT_THAT(document, ::testing::StartsWith("<?xml"));
  EXPECT_THAT(document, HasSubstr(".marker.tone-a{fill:#0072b2"));
  EXPECT_THAT(document, Not(HasSubstr("var(")));
  EXPECT_THAT(document, HasSubstr("viewBox=\"0 0 400.00 824.00\""));  // two of 400 by 400, each with 12 below
}

TEST(TodFigures, BarsOfGradedAnswersAreFromTheirScatterOverPresentations) {
  TodPoint point;
  // Means of 4 answers: 0.5, 0.6, 0.7, 0.8; mean 0.65, standard deviation 0.1291, of the mean 0.06455; t of 3: 3.1824.
  for (int k = 0; k < 4; ++k)
    point.levels.push_back({.size = 2, .correct = 4 * (0.5 + 0.1 * k), .total = 4, .cluster = k});
  const Interval independent = proportion_interval(answers_by_size(point)[0]);
  point.fit.dispersion = 0.1;
  const Interval graded = proportion_interval(answers_by_size(point)[0]);

  EXPECT_EQ(independent.low, wilson_interval(10.4, 16).low);
  EXPECT_NEAR(*graded.low, 0.65 - 3.1824 * 0.06455, 1e-4);
  EXPECT_NEAR(*graded.high, 0.65 + 3.1824 * 0.06455, 1e-4);
  for (Level& level : point.levels) level.correct = 4;
  EXPECT_EQ(proportion_interval(answers_by_size(point)[0]).low, 1) << "all certain: no scatter";
  point.levels.resize(1);
  EXPECT_FALSE(proportion_interval(answers_by_size(point)[0]).low) << "one presentation says nothing of scatter";
}

TEST(TodFigures, WilsonIntervalsAgreeWithTheScoreEquation) {
  // The bounds are the proportions q at which (p - q)^2 = z^2 q (1 - q) / n: checked by putting them back. Both sides
  // are below 1, so that a few roundings of 1e-16 stay below 1e-14.
  constexpr double z = 1.959963984540054;
  for (const auto& [correct, total] : {std::pair{0.0, 10.0}, {7.0, 10.0}, {10.0, 10.0}, {75.0, 300.0}}) {
    const Interval interval = wilson_interval(correct, total);

    const double p = correct / total;
    for (const double q : {*interval.low, *interval.high})
      EXPECT_NEAR((p - q) * (p - q), z * z * q * (1 - q) / total, 1e-14) << correct << " of " << total;
    EXPECT_LE(*interval.low, p);
    EXPECT_GE(*interval.high, p);
  }
  EXPECT_FALSE(wilson_interval(0, 0).low);
}

TEST(TodFigures, AnswersOfEqualSizeAreAddedUpOverPresentations) {
  TodPoint point;
  point.levels = {{2, 3, 4, 1}, {1, 1, 4, 0}, {2, 1, 4, 2}, {5, 0, 0, -1}, {1.0000001, 2, 4, 3}};

  const std::vector<AnswersAtSize> answers = answers_by_size(point);

  ASSERT_THAT(answers, SizeIs(2));
  EXPECT_EQ(answers[0].correct, 3);
  EXPECT_EQ(answers[0].total, 8);
  EXPECT_EQ(answers[1].size_mrad, 2);
  EXPECT_EQ(answers[1].correct, 4);
}

TEST(TodFigures, TheTodAxesAreLinearInAcuityAndLogarithmicInContrast) {
  const ReportData data = sample_report();

  const Plot plot = tod_figure({"measured", &*data.measured}, {"simulated", nullptr}, {});

  EXPECT_EQ(plot.x.scale, AxisScale::linear);
  EXPECT_EQ(plot.y.scale, AxisScale::logarithmic);
  ASSERT_THAT(plot.series, SizeIs(1));
  const PlotPoint& first = plot.series[0].points[0];
  EXPECT_DOUBLE_EQ(*first.x, 1 / 2.083);
  EXPECT_DOUBLE_EQ(*first.y, 16.9);
  EXPECT_DOUBLE_EQ(*first.x_interval.low, 1 / (2.083 * 1.026));
  EXPECT_GT(plot.x.high, *first.x_interval.high);
}

TEST(TodFigures, NegativeContrastsAreASeriesOfTheirOwn) {
  TodCurve curve;
  curve.points = {sample_point(2, 1.9, 2, 0.03), sample_point(-2, -1.8, 2.1, 0.03)};

  const Plot plot = tod_figure({"measured", &curve}, {"", nullptr}, {});

  ASSERT_THAT(plot.series, SizeIs(2));
  EXPECT_EQ(plot.series[0].label, "measured, ΔT < 0");
  EXPECT_DOUBLE_EQ(*plot.series[0].points[0].y, 1.8);
}

TEST(TodFigures, ARampIsALineWithItsBand) {
  TodCurve curve;
  curve.points = {sample_point(10, 9.9, 2, 0.03)};
  for (const double delta_t_k : {16.9, 1.0, 0.2}) curve.continuous.push_back({delta_t_k, 2, {1.6, 2.5}});

  const Plot plot = tod_figure({"measured", &curve}, {"", nullptr}, {});

  ASSERT_THAT(plot.series, SizeIs(4));
  EXPECT_DOUBLE_EQ(*plot.series[0].points[2].x, 0.4);
  EXPECT_DOUBLE_EQ(*plot.series[1].points[2].x, 0.625);
  EXPECT_DOUBLE_EQ(*plot.series[2].points[2].x, 0.5);
  EXPECT_DOUBLE_EQ(*plot.series[2].points[2].y, 0.2);
  EXPECT_EQ(plot.series[3].line, PlotLine::none);
  EXPECT_LT(plot.y.low, 0.2);
  EXPECT_GT(plot.y.high, 16.9);
}

TEST(TodFigures, TheAxisHoldsTheSizesThatARunIsGoingToShow) {
  TodPoint point = sample_point(20, 16.9, 2.083, 0.026);
  point.levels.resize(1);
  const std::vector<double> sizes_mrad{0.9, 8, 3};

  for (const TodPoint* measured : std::array<const TodPoint*, 2>{&point, nullptr}) {
    const Plot plot =
        psychometric_figure("p", {"measured", measured}, {"", nullptr}, PsychometricForm::size, sizes_mrad);

    EXPECT_LT(plot.x.low, 0.9);
    EXPECT_GT(plot.x.low, 0.7);
    EXPECT_GT(plot.x.high, 8);
    EXPECT_LT(plot.x.high, 10);
  }
}

TEST(TodFigures, TheFittedFunctionPassesThroughThreeQuartersAtTheThreshold) {
  const TodPoint point = sample_point(20, 16.9, 2.083, 0.026);

  const Plot plot = psychometric_figure("p", {"measured", &point}, {"", nullptr}, PsychometricForm::size);

  ASSERT_THAT(plot.series, SizeIs(2));
  const std::vector<PlotPoint>& curve = plot.series[0].points;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (*curve[i - 1].x > 2.083 || *curve[i].x < 2.083) continue;
    EXPECT_LE(*curve[i - 1].y, 0.75);
    EXPECT_GE(*curve[i].y, 0.75);
  }
  ASSERT_THAT(plot.bands, SizeIs(1));
  EXPECT_EQ(plot.bands[0].x.high, point.fit.ci95.high);
  EXPECT_THAT(plot.series[1].points, SizeIs(8));
}

TEST(TodFigures, APointWithoutTrialsStillMakesAFigure) {
  const TodPoint nothing;

  const Plot plot = psychometric_figure("p", {"measured", &nothing}, {"", nullptr}, PsychometricForm::acuity);

  EXPECT_TRUE(drawn(plot));
  EXPECT_THAT(plot.bands, IsEmpty());
}

}  // namespace
}  // namespace todbench
