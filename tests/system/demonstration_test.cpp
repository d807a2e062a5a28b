// SPDX-License-Identifier: GPL-3.0-or-later
// The whole job on the emulated laboratory.
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

TEST(Demonstration, MeasuresSimulatesComparesReportsAndPasses) {
  const TemporaryFolder folder;

  const Ended ended = todbench({"demo", "--out", "d"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("acuity measured [1/mrad]"));
  EXPECT_THAT(ended.out, HasSubstr("verdict: pass"));
  EXPECT_THAT(ended.out, HasSubstr("report: d/report.html"));
  expect_whole_session(folder.path() / "d", "complete");
  const std::string report = content_of(folder.path() / "d" / "report.html");
  EXPECT_THAT(report, HasSubstr("PASS"));
  EXPECT_THAT(report, HasSubstr("0.01 K/count, 250 K at 0 counts"));
  const Json comparison = Json::parse(content_of(folder.path() / "d" / "comparison.json"), nullptr, false);
  EXPECT_EQ(comparison["verdict"], "equivalent");
}

// The plan of `demo --full`, before the simulated sensor.
TEST(Demonstration, TheFullOneJudgesItsMeasuresByItsBudget) {
  const TemporaryFolder folder;

  const Ended ended =
      todbench({"simulate", "acceptance", "--accuracy", "draft", "--out", "s"}, {.folder = folder.path()});

  // The plan demands equivalence to a twin, which a simulation does not have.
  EXPECT_EQ(ended.code, 0) << ended.err;
  const Json verdict = Json::parse(content_of(folder.path() / "s" / "verdict.json"), nullptr, false);
  ASSERT_TRUE(verdict.contains("demands")) << verdict;
  int measures = 0;
  for (const Json& demand : verdict["demands"]) {
    const std::string kind = demand["kind"];
    EXPECT_NE(kind, "equivalence");
    EXPECT_EQ(demand["decision"], "pass") << demand;
    if (kind != "acuity" && kind != "identified") ++measures;
  }
  EXPECT_EQ(measures, 8);
  const Json budget = Json::parse(content_of(folder.path() / "s" / "uncertainty.json"), nullptr, false);
  EXPECT_EQ(budget.value("not_stated", Json()), Json::array()) << budget;
}

}  // namespace
}  // namespace todbench::testing
