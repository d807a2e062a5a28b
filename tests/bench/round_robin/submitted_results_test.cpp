// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/submitted_results.h"

#include <gmock/gmock.h>

#include "bench/report/html.h"
#include "bench/round_robin/round_robin_output.h"
#include "bench/text/text.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string refused_results(const std::string& text) {
  const auto parsed = parse_submitted_results(text, "r.csv");
  if (parsed) {
    const auto items = compared_items(*parsed);
    if (!items) return items.error().message;
    const auto found = evaluated(*items, 1);
    return found ? "taken" : found.error().message;
  }
  EXPECT_EQ(parsed.error().code, ErrorCode::invalid_input);
  return parsed.error().message;
}

TEST(SubmittedResults, StateTheirUncertaintyInThreeWays) {
  const auto found = parse_submitted_results(
      "value,laboratory,item,quantity,unit,u,expanded_u,k,ci95_low,ci95_high\n"
      "5,A,i,q,mrad,0.1,,,,\n5,B,i,q,mrad,,0.2,,,\n5,C,i,q,mrad,,0.3,3,,\n5,D,i,q,mrad,,,,4.8040036015459946,5."
      "1959963984540054\n",
      "r.csv");

  ASSERT_TRUE(found) << found.error().message;
  for (const SubmittedResult& result : *found) EXPECT_NEAR(result.u, 0.1, 1e-12) << result.laboratory;
}

TEST(SubmittedResults, ThatAreWrongAreRefusedInOneSentence) {
  const std::string head = "laboratory,item,quantity,value,u\n";
  EXPECT_THAT(refused_results("laboratory,item,quantity,value\nA,i,q,1\n"), HasSubstr("r.csv:1: missing uncertainty"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,\n"), HasSubstr("r.csv:2: missing uncertainty"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,0\n"), HasSubstr("r.csv:2: column u: expected a number above 0"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,-1\n"), HasSubstr("column u"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,nan\n"), HasSubstr("column u"));
  EXPECT_THAT(refused_results(head + "A,i,q,nan,1\n"), HasSubstr("column value"));
  EXPECT_THAT(refused_results(head + "A,i,q,1e308,1\n"), HasSubstr("column value"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,1e308\n"), HasSubstr("column u"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,1e-300\n"), HasSubstr("column u"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,1\nB,i,q,1,1\nA,i,q,2,1\n"),
              HasSubstr("r.csv:4: laboratory 'A' has a second result of item 'i', quantity 'q' (first: r.csv:2)"));
  EXPECT_THAT(refused_results(head + "A,i,q,1,1\n"), HasSubstr("at least two laboratories, found 1"));
  EXPECT_THAT(refused_results(head + ",i,q,1,1\n"), HasSubstr("column laboratory: expected a name"));
  EXPECT_THAT(refused_results(head), HasSubstr("expected at least one row"));
  EXPECT_THAT(refused_results(""), HasSubstr("r.csv"));
  EXPECT_THAT(refused_results("laboratory,item,quantity,value,u,unit\nA,i,q,1,1,mrad\nB,i,q,1,1,px\n"),
              HasSubstr("unit 'px' differs from 'mrad' in r.csv:2"));
  EXPECT_THAT(refused_results("laboratory,item,quantity,value,u,expanded_u\nA,i,q,1,1,2\n"),
              HasSubstr("found several"));
  EXPECT_THAT(refused_results("laboratory,item,quantity,value,ci95_low,ci95_high\nA,i,q,1,2,3\n"),
              HasSubstr("an interval that contains the value"));
  EXPECT_THAT(refused_results("laboratory,item,quantity,value,ci95_low\nA,i,q,1,2\n"), HasSubstr("needs both columns"));
  EXPECT_THAT(refused_results("laboratory,item,quantity,value,sd\nA,i,q,1,2\n"), HasSubstr("unknown column 'sd'"));
  EXPECT_THAT(refused_results("laboratory,item,quantity,value,u,u\nA,i,q,1,2,2\n"), HasSubstr("occurs twice"));
}

TEST(SubmittedResults, OfEveryDescribedSizeGiveFiniteNumbers) {
  EXPECT_EQ(refused_results("laboratory,item,quantity,value,u\nA,i,q,1e30,1e-30\nB,i,q,-1e30,1e30\nC,i,q,0,1e-30\n"),
            "taken");
}

RoundRobin round_robin_of(const std::string& text) {
  return *evaluated(*compared_items(*parse_submitted_results(text, "r.csv")), 1);
}

TEST(RoundRobinOutput, DisarmsFormulasAndMarkup) {
  const RoundRobin found = round_robin_of(
      "laboratory,item,quantity,value,u\n=cmd|' /C calc'!A0,<script>,q,1,0.1\n@SUM(A1),<script>,q,1.1,0.1\n");

  const std::string csv = round_robin_csv(found), page = render_html(round_robin_page(found, {}));

  EXPECT_THAT(csv, HasSubstr("'=cmd"));
  EXPECT_THAT(csv, HasSubstr("'@SUM"));
  EXPECT_THAT(page, Not(HasSubstr("<script>")));
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;"));
}

TEST(RoundRobinOutput, StatesReferenceDegreesAndVerdict) {
  const RoundRobin found = round_robin_of("laboratory,item,quantity,value,u\nA,i,q,10,1\nB,i,q,13,2\n");

  const Json json = round_robin_json(found, {});

  EXPECT_EQ(json["verdict"], "consistent");
  EXPECT_EQ(json["items"][0]["reference"]["method"], "weighted_mean");
  EXPECT_NEAR(json["items"][0]["reference"]["value"].get<double>(), 10.6, 1e-12);
  EXPECT_NEAR(json["items"][0]["results"][1]["e_n"].get<double>(), 2.4 / (2 * std::sqrt(3.2)), 1e-12);
  EXPECT_TRUE(json["items"][0]["truth"].is_null());
}

TEST(SealedTruth, IsComparedWithTheReferenceValues) {
  const testing::TemporaryFolder folder;
  const RoundRobin found = round_robin_of("laboratory,item,quantity,value,u\nA,i,q,10,1\nB,i,q,13,2\n");
  const auto file = folder.write("sealed.json",
                                 R"({"schema": "todbench-round-robin-1",
                                     "items": [{"item": "i", "quantity": "q", "value": 10, "u": 0.1}]})");

  const auto checks = checked_against(found, *read_sealed(file));

  ASSERT_TRUE(checks) << checks.error().message;
  EXPECT_NEAR(checks->front().difference, 0.6, 1e-12);
  EXPECT_NEAR(checks->front().e_n, 0.6 / std::hypot(2 * std::sqrt(0.8), 0.2), 1e-12);
  EXPECT_TRUE(checks->front().held);
  const RoundRobin other = round_robin_of("laboratory,item,quantity,value,u\nA,x,q,10,1\nB,x,q,13,2\n");
  EXPECT_THAT(checked_against(other, *read_sealed(file)).error().message, HasSubstr("has no item 'x'"));
  EXPECT_EQ(read_sealed(folder.write("other.json", "{\"schema\": 3}")).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(read_sealed(folder.write("none.json", "[")).error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
