// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/report_csv.h"

#include <gmock/gmock.h>

#include <sstream>

#include "bench/text/text.h"
#include "tests/bench/report/report_sample.h"

namespace todbench {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

using Rows = std::vector<std::vector<std::string>>;

Rows rows_of(const ReportData& data) {
  Rows rows;
  std::istringstream table(report_csv(data));
  for (std::string line; std::getline(table, line);) {
    const auto fields = split_csv(line);
    EXPECT_TRUE(fields) << line;
    if (fields) rows.push_back(*fields);
  }
  return rows;
}

Rows rows_of(const ReportData& data, std::string_view section, std::string_view name) {
  Rows chosen;
  for (const auto& row : rows_of(data)) {
    if (row[0] == section && row[1] == name) chosen.push_back(row);
  }
  return chosen;
}

TEST(ReportCsv, HasTheColumnsOfTheDocumentsInEveryRow) {
  const Rows rows = rows_of(sample_report());

  EXPECT_THAT(rows.front(), ElementsAre("section", "name", "set_delta_t_k", "value", "low", "high", "interval_percent",
                                        "limit", "unit", "decision", "text", "definition"));
  EXPECT_THAT(rows, Each(SizeIs(12)));
}

TEST(ReportCsv, HasTheNumbersOfEveryPointAsTheyAre) {
  const ReportData data = sample_report();
  const Rows rows = rows_of(data, "measured", "s75_mrad");

  ASSERT_EQ(rows.size(), data.measured->points.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TodPoint& point = data.measured->points[i];
    EXPECT_EQ(parse_number(rows[i][2]), point.set_delta_t_k);
    EXPECT_EQ(parse_number(rows[i][3]), point.fit.threshold);
    EXPECT_EQ(parse_number(rows[i][4]), point.fit.ci95.low);
    EXPECT_EQ(parse_number(rows[i][5]), point.fit.ci95.high);
  }
}

TEST(ReportCsv, HasEveryDemandWithItsDecision) {
  const ReportData data = sample_report();
  std::size_t demands = 0;
  for (const auto& row : rows_of(data)) {
    if (row[0] != "demand") continue;
    const Demand& demand = data.verdict->demands[demands++];
    EXPECT_EQ(row[9], to_string(demand.decision));
    EXPECT_EQ(row[7].empty(), !demand.limit.has_value());
  }
  EXPECT_EQ(demands, data.verdict->demands.size());
  ASSERT_THAT(rows_of(data, "verdict", "decision"), SizeIs(1));
  EXPECT_EQ(rows_of(data, "verdict", "decision")[0][9], to_string(data.verdict->decision));
}

TEST(ReportCsv, LeavesWhatIsNotThereEmpty) {
  ReportData data = sample_report();
  data.measured->points[0].fit.threshold.reset();
  data.measured->points[0].fit.ci95 = {};
  data.comparison.reset();

  const Rows rows = rows_of(data, "measured", "acuity_per_mrad");

  EXPECT_EQ(rows[0][3] + rows[0][4] + rows[0][5], "");
  EXPECT_THAT(rows_of(data, "comparison", "acuity_ratio"), SizeIs(0));
}

TEST(ReportCsv, GivesNoVerdictOfChangedFiles) {
  ReportData data = sample_report();
  data.accepted_changes = {"fits.json"};

  EXPECT_EQ(rows_of(data, "verdict", "decision")[0][9], "none");
  EXPECT_THAT(rows_of(data, "session", "changed_file"), SizeIs(1));
  for (const auto& row : rows_of(data)) EXPECT_NE(row[0], "demand");
}

TEST(ReportCsv, KeepsTextsOfOthersInOneField) {
  ReportData data = sample_report();
  data.operator_name = "A, \"B\"\nverdict,decision,,,,,,,,pass,";

  EXPECT_THAT(rows_of(data), Each(SizeIs(12)));
  EXPECT_THAT(rows_of(data, "verdict", "decision"), SizeIs(1));
}

}  // namespace
}  // namespace todbench
