#include "bench/judgement/verdict.h"

#include <gmock/gmock.h>

#include <cmath>

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr double limit_per_mrad = 0.4;
constexpr double limit_mrad = 1 / limit_per_mrad;  // S75 that just meets the limit
const double above_mrad = std::nextafter(limit_mrad, 10.0);
const double below_mrad = std::nextafter(limit_mrad, 0.0);

LimitsPlan one_limit() {
  return {{{16.9, limit_per_mrad}}, std::nullopt};
}

TodPoint point_with(FitVerdict verdict, std::optional<double> low_mrad, std::optional<double> high_mrad) {
  TodPoint point;
  point.set_delta_t_k = 16.9;
  point.fit.verdict = verdict;
  point.fit.ci95 = {low_mrad, high_mrad};
  if (low_mrad && high_mrad) point.fit.threshold = (*low_mrad + *high_mrad) / 2;
  return point;
}

struct Row {
  const char* name;
  FitVerdict fit;
  std::optional<double> low_mrad, high_mrad;
  VerdictKind expected;
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.name;
}

class TruthTable : public ::testing::TestWithParam<Row> {};

TEST_P(TruthTable, TheIntervalDecides) {
  const Row& row = GetParam();

  const Verdict verdict =
      judge(one_limit(), {"o", "s", {point_with(row.fit, row.low_mrad, row.high_mrad)}}, std::nullopt);

  ASSERT_EQ(verdict.items.size(), 1u);
  EXPECT_EQ(verdict.items[0].kind, row.expected) << verdict.items[0].reason;
  EXPECT_EQ(verdict.overall, row.expected);
  EXPECT_FALSE(verdict.items[0].reason.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Acuity, TruthTable,
    ::testing::Values(
        Row{"well_above", FitVerdict::ok, 1.5, 1.8, VerdictKind::pass},
        Row{"well_below", FitVerdict::ok, 3.0, 3.5, VerdictKind::fail},
        Row{"straddling", FitVerdict::ok, 2.0, 3.0, VerdictKind::inconclusive},
        // A limit is a least value: meeting it exactly is meeting it.
        Row{"worse_end_exactly_on_the_limit", FitVerdict::ok, 2.0, limit_mrad, VerdictKind::pass},
        Row{"worse_end_one_step_beyond", FitVerdict::ok, 2.0, above_mrad, VerdictKind::inconclusive},
        Row{"worse_end_one_step_within", FitVerdict::ok, 2.0, below_mrad, VerdictKind::pass},
        Row{"better_end_exactly_on_the_limit", FitVerdict::ok, limit_mrad, 3.0, VerdictKind::inconclusive},
        Row{"better_end_one_step_beyond", FitVerdict::ok, above_mrad, 3.0, VerdictKind::fail},
        Row{"better_end_one_step_within", FitVerdict::ok, below_mrad, 3.0, VerdictKind::inconclusive},
        Row{"extrapolated_but_clear", FitVerdict::extrapolated, 1.5, 1.8, VerdictKind::pass},
        Row{"step_with_both_sides", FitVerdict::step, 3.0, 3.5, VerdictKind::fail},
        Row{"never_right_and_limit_below", FitVerdict::above_range, 3.0, std::nullopt, VerdictKind::fail},
        Row{"never_right_and_limit_within", FitVerdict::above_range, 2.0, std::nullopt, VerdictKind::inconclusive},
        Row{"always_right_and_limit_above", FitVerdict::below_range, std::nullopt, 2.0, VerdictKind::pass},
        Row{"always_right_and_limit_within", FitVerdict::below_range, std::nullopt, 3.0, VerdictKind::inconclusive},
        Row{"no_sides", FitVerdict::slope_unidentifiable, std::nullopt, std::nullopt, VerdictKind::inconclusive},
        Row{"no_data", FitVerdict::no_data, std::nullopt, std::nullopt, VerdictKind::inconclusive},
        // At the lower bound of the slope a threshold number means nothing, however narrow.
        Row{"flat", FitVerdict::flat_or_decreasing, 1.5, 1.8, VerdictKind::inconclusive}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Judge, AContrastThatWasNotMeasuredIsInconclusive) {
  TodPoint other = point_with(FitVerdict::ok, 1.5, 1.8);
  other.set_delta_t_k = 1.93;

  const Verdict verdict = judge(one_limit(), {"o", "s", {other}}, std::nullopt);

  EXPECT_EQ(verdict.overall, VerdictKind::inconclusive);
  EXPECT_EQ(verdict.items.at(0).reason, "this contrast was not measured");
}

TEST(Judge, ASignificantFreeLapseMakesBothFitsCount) {
  TodPoint point = point_with(FitVerdict::ok, 1.5, 1.8);
  point.free_lapse_fit = point_with(FitVerdict::ok, 2.0, 3.0).fit;
  const TodCurve without_warning{"o", "s", {point}};
  point.lapse_warning = true;
  const TodCurve with_warning{"o", "s", {point}};

  EXPECT_EQ(judge(one_limit(), without_warning, std::nullopt).overall, VerdictKind::pass);
  EXPECT_EQ(judge(one_limit(), with_warning, std::nullopt).overall, VerdictKind::inconclusive);
}

TEST(Judge, OneFailureOutweighsEverythingAndDoubtOutweighsPasses) {
  TodPoint good = point_with(FitVerdict::ok, 1.5, 1.8), open = good, bad = good;
  open.set_delta_t_k = 1.93;
  open.fit.ci95 = {2.0, 3.0};
  bad.set_delta_t_k = 0.23;
  bad.fit.ci95 = {3.0, 3.5};
  const TodCurve curve{"o", "s", {good, open, bad}};
  LimitsPlan limits = one_limit();

  EXPECT_EQ(judge(limits, curve, std::nullopt).overall, VerdictKind::pass);
  limits.acuity.push_back({1.93, limit_per_mrad});
  EXPECT_EQ(judge(limits, curve, std::nullopt).overall, VerdictKind::inconclusive);
  limits.acuity.push_back({0.23, limit_per_mrad});
  EXPECT_EQ(judge(limits, curve, std::nullopt).overall, VerdictKind::fail);
}

TEST(Judge, WithoutLimitsEveryIdentifiedThresholdPasses) {
  const Verdict verdict = judge({}, {"o", "s", {point_with(FitVerdict::ok, 2.0, 3.0)}}, std::nullopt);

  EXPECT_EQ(verdict.overall, VerdictKind::pass);
  EXPECT_TRUE(verdict.items.empty());
}

TEST(Judge, WithoutLimitsAThresholdThatCannotBeIdentifiedIsInconclusive) {
  const Verdict verdict = judge({}, {"o", "s", {point_with(FitVerdict::above_range, 2.0, std::nullopt)}}, std::nullopt);

  EXPECT_EQ(verdict.overall, VerdictKind::inconclusive);
  EXPECT_THAT(verdict.items.at(0).reason, HasSubstr("above_range"));
}

TEST(Judge, ACurveWithoutPointsIsInconclusive) {
  EXPECT_EQ(judge({}, {}, std::nullopt).overall, VerdictKind::inconclusive);
}

TEST(Judge, DemandedEquivalenceIsWhatTheComparisonSays) {
  const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, 1.5, 1.8)}};
  const LimitsPlan limits{{}, 10.0};
  const auto judged = [&](ComparisonVerdict verdict, double margin_percent) {
    ComparisonPoint point;
    point.margin_percent = margin_percent;
    return judge(limits, curve, Comparison{{point}, verdict}).overall;
  };

  EXPECT_EQ(judged(ComparisonVerdict::equivalent, 10), VerdictKind::pass);
  EXPECT_EQ(judged(ComparisonVerdict::different, 10), VerdictKind::fail);
  EXPECT_EQ(judged(ComparisonVerdict::inconclusive, 10), VerdictKind::inconclusive);
  EXPECT_EQ(judged(ComparisonVerdict::equivalent, 20), VerdictKind::inconclusive);  // shown for a wider margin only
  EXPECT_EQ(judge(limits, curve, std::nullopt).overall, VerdictKind::inconclusive);
}

TEST(Judge, EquivalenceThatWasNotDemandedDoesNotCount) {
  const Comparison different{{}, ComparisonVerdict::different};

  EXPECT_EQ(judge({}, {"o", "s", {point_with(FitVerdict::ok, 1.5, 1.8)}}, different).overall, VerdictKind::pass);
}

TEST(Judge, NamesItsRule) {
  EXPECT_THAT(judge({}, {}, std::nullopt).rule, HasSubstr("95 % confidence interval as guard band"));
  EXPECT_THAT(decision_rule(), HasSubstr("ILAC-G8"));
}

TEST(Judge, SaysDemandValueAndIntervalInAcuity) {
  const Verdict verdict = judge(one_limit(), {"o", "s", {point_with(FitVerdict::ok, 1.6, 2.0)}}, std::nullopt);

  const VerdictItem& item = verdict.items.at(0);
  EXPECT_EQ(item.demand, "acuity at 16.9 K at least 0.4 1/mrad");
  EXPECT_EQ(item.limit, 0.4);
  EXPECT_DOUBLE_EQ(item.value.value(), 1 / 1.8);
  EXPECT_EQ(item.interval.low, 0.5);
  EXPECT_EQ(item.interval.high, 0.625);
  EXPECT_EQ(item.reason, "95 % interval 0.5 to 0.625 1/mrad: at or above the limit");
}

TEST(ExitCode, FollowsTheCommandLineContract) {
  EXPECT_EQ(exit_code(VerdictKind::pass), 0);
  EXPECT_EQ(exit_code(VerdictKind::fail), 1);
  EXPECT_EQ(exit_code(VerdictKind::inconclusive), 3);
  EXPECT_EQ(exit_code(ErrorCode::invalid_input), 2);
  EXPECT_EQ(exit_code(ErrorCode::not_found), 4);
  EXPECT_EQ(exit_code(ErrorCode::disconnected), 5);
  EXPECT_EQ(exit_code(ErrorCode::integrity), 5);
  EXPECT_EQ(exit_code(ErrorCode::timeout), 5);
  EXPECT_EQ(exit_code(ErrorCode::calibration), 6);
  EXPECT_EQ(exit_code(ErrorCode::io), 7);
  EXPECT_EQ(exit_code(ErrorCode::internal), 7);
  EXPECT_EQ(exit_code(ErrorCode::interrupted), 130);
}

TEST(ExitCode, OfAFitIsThreeWhereTheThresholdCannotBeIdentified) {
  EXPECT_EQ(exit_code(point_with(FitVerdict::ok, 1.5, 1.8).fit), 0);
  EXPECT_EQ(exit_code(point_with(FitVerdict::extrapolated, 1.5, 1.8).fit), 0);
  EXPECT_EQ(exit_code(point_with(FitVerdict::above_range, 1.5, std::nullopt).fit), 3);
  EXPECT_EQ(exit_code(point_with(FitVerdict::flat_or_decreasing, 1.5, 1.8).fit), 3);
  EXPECT_EQ(exit_code(PsychometricFit{}), 3);
}

}  // namespace
}  // namespace todbench
