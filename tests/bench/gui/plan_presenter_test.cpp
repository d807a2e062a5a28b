#include "bench/gui/plan_presenter.h"

#include <gmock/gmock.h>

#include "tests/bench/gui/gui_test_support.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::wait_until;

struct Bench {
  testing::TemporaryFolder folder;
  Workbench bench{folder.path()};
  PlanPresenter presenter{bench};
  ~Bench() { bench.shut_down(); }
};

TEST(PlanPresenter, RefusesWhatAPlanFileMayNotSayAndKeepsTheOldPlan) {
  Bench b;
  Plan plan = b.presenter.plan();
  plan.target.distance_m = -1;

  const QString wrong = b.presenter.apply(plan);

  EXPECT_THAT(wrong.toStdString(), HasSubstr("distance_m"));
  EXPECT_GT(b.presenter.plan().target.distance_m, 0);
}

TEST(PlanPresenter, ShowsAsTomlWhatTheFormSaysAndTheOtherWayRound) {
  Bench b;
  Plan plan = b.presenter.plan();
  plan.operator_name = "P. Example";

  EXPECT_EQ(b.presenter.apply(plan).toStdString(), "");
  EXPECT_THAT(b.presenter.toml().toStdString(), HasSubstr("P. Example"));
  EXPECT_EQ(b.presenter.apply_toml(b.presenter.toml().replace("P. Example", "Q. Other")).toStdString(), "");

  EXPECT_EQ(b.presenter.plan().operator_name, "Q. Other");
}

TEST(PlanPresenter, CountsTheAnswersOfAPlan) {
  Bench b;

  // 2 plates of 20 triangles, 4 mountings, 3 contrasts, 12 phases.
  EXPECT_EQ(b.presenter.outlook().presentations, 2u * 4 * 3 * 12);
  EXPECT_EQ(b.presenter.outlook().trials, 2u * 20 * 4 * 3 * 12);
}

TEST(PlanPresenter, NeedsFourTimesTheAnswersForHalfTheUncertainty) {
  Bench b;
  ASSERT_TRUE(wait_until([&] { return b.presenter.expected_known(); }));

  Plan plan = b.presenter.plan();
  plan.target.phases = 8;
  ASSERT_EQ(b.presenter.apply(plan).toStdString(), "");
  const auto coarse = b.presenter.outlook().uncertainty_percent();
  const double coarse_s = b.presenter.outlook().duration_s;
  plan.target.phases = 32;
  ASSERT_EQ(b.presenter.apply(plan).toStdString(), "");
  const auto fine = b.presenter.outlook().uncertainty_percent();

  ASSERT_TRUE(coarse && fine);
  // expm1 of half the exponent: exactly a half only for small ones.
  EXPECT_NEAR(std::log1p(*coarse / 100) / std::log1p(*fine / 100), 2, 1e-9);
  EXPECT_GT(b.presenter.outlook().duration_s, coarse_s);
}

TEST(PlanPresenter, SetsAsManyPhasesAsTheToleranceNeedsAndNoMore) {
  Bench b;
  ASSERT_TRUE(wait_until([&] { return b.presenter.expected_known(); }));

  ASSERT_EQ(b.presenter.set_tolerance_percent(5).toStdString(), "");
  const int phases = b.presenter.plan().target.phases;
  EXPECT_LE(*b.presenter.outlook().uncertainty_percent(), 5);
  Plan fewer = b.presenter.plan();
  fewer.target.phases = phases - 1;
  ASSERT_EQ(b.presenter.apply(fewer).toStdString(), "");

  EXPECT_GT(*b.presenter.outlook().uncertainty_percent(), 5);
}

TEST(PlanPresenter, SaysThatAPlateDoesNotFitBeforeAnythingIsMeasured) {
  Bench b;
  Plan plan = b.presenter.plan();
  plan.target.distance_m = 0.4;

  ASSERT_EQ(b.presenter.apply(plan).toStdString(), "");

  EXPECT_TRUE(wait_until([&] { return b.presenter.misfit().contains("distance_m"); }));
}

}  // namespace
}  // namespace todbench
