// SPDX-License-Identifier: GPL-3.0-or-later
// Figures and page of a sweep.
#include "bench/sweep/sweep_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "bench/report/html.h"
#include "bench/sweep/sweep_effects.h"
#include "bench/sweep/sweep_page.h"
#include "tests/bench/sweep/sweep_support.h"

namespace todbench {
namespace {

using namespace testing_support;
using ::testing::HasSubstr;

TEST(SweepContours, OfDrawnParametersAreMeansOfSquaresWithTheNumberOfDraws) {
  const RandomStream noise(3, "sweep_test.contours");
  const auto plane = [](const auto& x, std::size_t) { return x[1] + 2 * x[2]; };
  const std::string ranges = "ranges = { other = [0, 1], a = [0, 1], b = [10, 12] }\n";
  for (const std::string& text : {"[sample]\nkind = \"sobol\"\nn = 1024\n" + ranges, "[sample]\nn = 1024\n" + ranges,
                                  total_sample(512, 1, "other = [0, 1], a = [0, 1], b = [10, 12]")}) {
    const Sweep sweep = expanded(text + "[repeat]\nseeds = 2\n");
    const SweepTable table = table_of(sweep, plane);
    const auto effects = sweep_effects(sweep, table, "y");

    const auto grid = response_grid(sweep, table, effects[0]);

    ASSERT_TRUE(grid) << grid.error().message;
    EXPECT_EQ(grid->x_key, "b");
    EXPECT_EQ(grid->y_key, "a");
    EXPECT_EQ(grid->points, 1024u) << "repeats are no draws, mixtures of A and B neither";
    EXPECT_GE(grid->least, 8u);
    ASSERT_GE(grid->x.size(), 5u);
    // A draw lies within half a square of the middle: the mean of eight or more is off by at most so much.
    const double half = 0.5 / static_cast<double>(grid->x.size());
    for (std::size_t i = 0; i < grid->x.size(); ++i) {
      for (std::size_t j = 0; j < grid->y.size(); ++j)
        EXPECT_NEAR(grid->mean[i][j], grid->y[j] + 2 * grid->x[i], half * (1 + 4));
    }
    EXPECT_TRUE(contour_plot(*grid, effects[0], "c"));

    const SweepTable chance = table_of(sweep, [&](const auto&, std::size_t i) { return noise.normal(i); });
    EXPECT_EQ(response_grid(sweep, chance, sweep_effects(sweep, chance, "y")[0]).error().code,
              ErrorCode::not_identifiable);
  }
  const Sweep few = expanded("[sample]\nn = 40\n" + ranges);
  const SweepTable table = table_of(few, plane);
  EXPECT_EQ(response_grid(few, table, sweep_effects(few, table, "y")[0]).error().code, ErrorCode::not_identifiable);
}

/// A grid whose response is a function of its two parameters.
ResponseGrid grid_of(const std::function<double(double, double)>& response) {
  ResponseGrid grid{.x_key = "a", .y_key = "b", .x = {0, 1, 3}, .y = {-1, 2}, .mean = {}};
  for (const double x : grid.x) {
    grid.mean.emplace_back();
    for (const double y : grid.y) grid.mean.back().push_back(response(x, y));
  }
  return grid;
}

TEST(SweepContours, OfAPlaneAreStraightLinesThroughEveryCell) {
  const auto grid = grid_of([](double x, double y) { return x + 2 * y; });

  const auto stretches = contour(grid, 1.5);

  ASSERT_EQ(stretches.size(), 2u);
  double length = 0;
  for (const auto& [from, to] : stretches) {
    EXPECT_NEAR(from.x + 2 * from.y, 1.5, 1e-12);
    EXPECT_NEAR(to.x + 2 * to.y, 1.5, 1e-12);
    length += std::hypot(to.x - from.x, to.y - from.y);
  }
  // From x = 0 (y = 0.75) to x = 3 (y = -0.75).
  EXPECT_NEAR(length, std::hypot(3, 1.5), 1e-12);
  EXPECT_TRUE(contour(grid, 100).empty());
}

TEST(SweepContours, OfASaddleCutOffTheCornersThatTheMiddleDoesNotBelongTo) {
  ResponseGrid grid{.x_key = "a", .y_key = "b", .x = {0, 1}, .y = {0, 1}, .mean = {{1, 0}, {0, 1}}};

  const auto low = contour(grid, 0.25), high = contour(grid, 0.75);

  // The middle is 0.5: above 0.25 it belongs to (0, 0) and (1, 1), so the lines cut off (1, 0) and (0, 1).
  ASSERT_EQ(low.size(), 2u);
  for (const auto& [from, to] : low) EXPECT_GT(std::abs((from.x + to.x) / 2 - (from.y + to.y) / 2), 0.5);
  ASSERT_EQ(high.size(), 2u);
  for (const auto& [from, to] : high) EXPECT_GT(std::abs((from.x + to.x) / 2 + (from.y + to.y) / 2 - 1), 0.5);
}

TEST(SweepPage, HasAFigureForEveryQuestionOrSaysWhyThereIsNone) {
  SweepTable table;
  table.columns = {"a", "b", "word", "repeat", "delta_t_k", "y"};
  const Sweep sweep = expanded("[grid]\na = [0, 1, 2]\nb = [0, 1]\nword = [\"x\", \"<y>\"]\n[repeat]\nseeds = 2\n");
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    const auto values = values_of(sweep, i);
    const double a = *parse_number(values[0]), b = *parse_number(values[1]);
    table.rows.push_back({a, b, values[2], sweep.task(i).repeat, 2.0, 3 * a + b + 0.01 * static_cast<double>(i % 2)});
  }
  table.tasks = sweep.count();
  const auto effects = sweep_effects(sweep, table, "y");
  ASSERT_EQ(effects.size(), 1u);

  const auto tornado_drawing = tornado(effects[0], "t");
  const auto grid = response_grid(sweep, table, effects[0]);
  const std::string page = render_html(sweep_page(sweep, table, effects));

  ASSERT_TRUE(tornado_drawing && grid);
  EXPECT_EQ(tornado_drawing->labels.size() > 6, true);
  EXPECT_EQ(grid->x_key, "a");
  EXPECT_NEAR(grid->mean[2][1], 7.005, 1e-12);
  EXPECT_THAT(page, HasSubstr("&lt;y&gt;"));
  EXPECT_FALSE(response_curve(effects[0], effects[0].parameters[2], "c"));
  EXPECT_TRUE(render_html(sweep_page(sweep, table, {})).size() > 100);
  ResponseEffects one{"y", 1, {{.key = "a", .levels = {{"1", 2, {}, 1}}}}};
  EXPECT_EQ(tornado(one, "t").error().code, ErrorCode::not_identifiable);
  EXPECT_EQ(response_grid(sweep, SweepTable{}, effects[0]).error().code, ErrorCode::not_identifiable);
}

}  // namespace
}  // namespace todbench
