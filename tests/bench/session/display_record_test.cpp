// SPDX-License-Identifier: GPL-3.0-or-later
// What stands beside the results for an operator at the display: record, report, and the run that finds it.
#include "bench/session/display_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/plan/loaded_plan.h"
#include "bench/report/html.h"
#include "bench/session/provenance.h"
#include "bench/twin/acuity_limits.h"
#include "tests/bench/report/report_sample.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

DisplayRecord seen_record() {
  return {.observer = "hvs-2",
          .points = {{16.9, 2.25, std::pair(1.9, 3.5)}, {0.23, 4.5, std::nullopt}},
          .limits = {{16.9, 2.25, {{LimitingFactor::eye, 30}, {LimitingFactor::sampling, 20}}}, {0.23, 4.5, {}}}};
}

TEST(DisplayRecord, IsReadAsItWasWrittenWithTheProvenance) {
  Provenance provenance = begin_provenance(Plan{}, Side::simulated);
  EXPECT_FALSE(provenance_json(provenance)->contains("at_display"));
  provenance.at_display = seen_record();

  const auto json = provenance_json(provenance);
  const auto read = provenance_from(*json);

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->at_display, provenance.at_display);
  EXPECT_EQ((*json)["at_display"]["acuity_limits"], acuity_limits_json(provenance.at_display->limits));
}

TEST(DisplayRecord, StandsInTheReportBesideTheResults) {
  ReportData data = sample_report();
  EXPECT_THAT(render_html(report_document(data)), Not(HasSubstr("Operator at the display")));
  data.at_display = seen_record();

  const std::string page = render_html(report_document(data));

  EXPECT_THAT(page, HasSubstr("Operator at the display"));
  EXPECT_THAT(page, HasSubstr("As an operator at this display would see it: hvs-2"));
  EXPECT_THAT(page, HasSubstr("1.90 to 3.50"));
  EXPECT_THAT(page, HasSubstr("no confidence interval"));
}

TEST(DisplayRecord, OfARunHasThresholdsOfHvs2OnlyBesideAnotherObserver) {
  const std::string scene =
      "[target]\nkind = \"scene\"\ndistance_m = 2\nplates = [\"tcat-a\"]\ndelta_t_k = [16.9]\n[simulation]\nsensor = "
      "\"sc2000\"\naccuracy = \"draft\"\n[display]\npixel_pitch_mm = 0.25\nviewing_distance_m = "
      "0.6\nluminance_white_cd_m2 = 100\nzoom = 2\n";
  TodCurve curve;
  curve.points.emplace_back().delta_t_k = 16.9;
  const auto found = [&](const std::string& more) {
    const auto loaded = read_plan({.origin = "p.toml", .text = scene + more}, "").value();
    EffectPlanner planner;
    return at_display(curve, experiment_inputs(loaded, planner).value(), loaded.plan(), {}).value();
  };

  const auto neither = found("");
  const auto beside = found("as_operator = true\n");
  const auto itself = found("[observer]\nname = \"hvs-2\"\n");

  EXPECT_FALSE(neither);
  ASSERT_TRUE(beside && itself);
  EXPECT_EQ(beside->observer, "hvs-2");
  ASSERT_EQ(beside->points.size(), 1u);
  ASSERT_TRUE(beside->points[0].spread_mrad);
  EXPECT_LT(beside->points[0].spread_mrad->first, beside->points[0].s75_mrad);
  EXPECT_GT(beside->points[0].spread_mrad->second, beside->points[0].s75_mrad);
  EXPECT_TRUE(itself->points.empty());
  ASSERT_EQ(itself->limits.size(), 1u);
  // Both are hvs-2 at one display; the planner may skip other effects for another observer (draft accuracy: 1 %).
  ASSERT_EQ(beside->limits.size(), 1u);
  EXPECT_NEAR(beside->limits[0].s75_mrad / itself->limits[0].s75_mrad, 1, 0.02);
  EXPECT_EQ(beside->limits[0].costs.size(), 5u) << "all but that of an observer without an eye";
}

TEST(DisplayRecord, AsOperatorNeedsADisplay) {
  const auto loaded = read_plan({.origin = "p.toml",
                                 .text = "[target]\ndistance_m = 2\nplates = [\"tcat-a\"]\n[display]\nas_operator = "
                                         "true\n"},
                                "");

  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("state the display"));
}

}  // namespace
}  // namespace todbench
