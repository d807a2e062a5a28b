#include "bench/gui/presenters/plan_fields.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

namespace todbench {
namespace {

Plan demo() {
  auto plan = load_plan("demo");
  EXPECT_TRUE(plan) << plan.error().message;
  return *plan;
}

const PlanField& field(const std::vector<PlanField>& fields, const QString& name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.object_name == name; });
  EXPECT_NE(found, fields.end());
  return *found;
}

TEST(PlanFields, ReadBackWhatTheyShowAndChangeNothingElse) {
  const Plan plan = demo();
  std::set<QString> names;
  for (const PlanField& f : plan_fields()) {
    Plan entered = plan;
    EXPECT_EQ(f.entered(entered, f.shown(plan)), "") << f.label.toStdString();
    EXPECT_EQ(to_toml(entered), to_toml(plan)) << f.label.toStdString();
    EXPECT_TRUE(names.insert(f.object_name).second) << "twice: " << f.object_name.toStdString();
  }
}

TEST(PlanFields, SayWhatTheyCannotReadAndLeaveThePlanAsItIs) {
  const auto fields = plan_fields();
  const Plan plan = demo();
  for (const auto& [name, text] : std::vector<std::pair<QString, QString>>{{"planDistance", "two"},
                                                                           {"planIfov", "1,3"},
                                                                           {"planContrasts", "16.9, cold"},
                                                                           {"planMountings", "upside_down"},
                                                                           {"planPhases", "4.5"},
                                                                           {"planLimits", "16.9"},
                                                                           {"planMargin", "ten"},
                                                                           {"planRecord", "perhaps"}}) {
    Plan entered = plan;
    EXPECT_NE(field(fields, name).entered(entered, text), "") << name.toStdString();
    EXPECT_EQ(to_toml(entered), to_toml(plan)) << name.toStdString();
  }
}

TEST(PlanFields, PutLimitsAndAnEmptyMarginIntoThePlan) {
  const auto fields = plan_fields();
  Plan plan = demo();

  EXPECT_EQ(field(fields, "planLimits").entered(plan, "16.9: 0.4, 0.23: 0.2"), "");
  EXPECT_EQ(field(fields, "planMargin").entered(plan, ""), "");

  ASSERT_EQ(plan.limits.acuity.size(), 2u);
  EXPECT_EQ(plan.limits.acuity[1].delta_t_k, 0.23);
  EXPECT_EQ(plan.limits.acuity[1].least_acuity_per_mrad, 0.2);
  EXPECT_FALSE(plan.limits.equivalence_margin_percent);
}

}  // namespace
}  // namespace todbench
