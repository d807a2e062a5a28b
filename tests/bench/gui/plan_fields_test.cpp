// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/plan_fields.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "bench/gui/presenters/plan_form.h"

namespace todbench {
namespace {

Plan demo() {
  auto plan = load_plan("demo");
  EXPECT_TRUE(plan) << plan.error().message;
  return *plan;
}

const PlanField& field(const std::vector<PlanField>& fields, QAnyStringView name) {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return QAnyStringView(f.object_name) == name; });
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
                                                                           {"planContrasts", "16.9: bright"},
                                                                           {"planContrasts", "16.9: 0.4: 3"},
                                                                           {"planMargin", "ten"},
                                                                           {"planRecord", "perhaps"}}) {
    Plan entered = plan;
    EXPECT_NE(field(fields, name).entered(entered, text), "") << name.toStdString();
    EXPECT_EQ(to_toml(entered), to_toml(plan)) << name.toStdString();
  }
}

TEST(PlanFields, HaveTheKindThatTheValueAsksFor) {
  const auto fields = plan_fields();

  for (const auto& [name, kind] :
       std::vector<std::pair<QString, FieldKind>>{{"planName", FieldKind::text},
                                                  {"planDistance", FieldKind::number},
                                                  {"planPhases", FieldKind::whole},
                                                  {"planRecord", FieldKind::yes_no},
                                                  {"planAccuracy", FieldKind::choice},
                                                  {"planObserver", FieldKind::name},
                                                  {"planMountings", FieldKind::boxes},
                                                  {"planPlates", FieldKind::rows},
                                                  {"planTransferSteps", FieldKind::rows},
                                                  {"planGeometry", FieldKind::yes_no},
                                                  {"planDriftTime", FieldKind::number},
                                                  {"planResponseSettling", FieldKind::number},
                                                  {"planMeasureLimits", FieldKind::rows},
                                                  {"planZoneLimits", FieldKind::rows},
                                                  {"planFleets", FieldKind::rows},
                                                  {"planLetterhead", FieldKind::file},
                                                  {"planContrasts", FieldKind::rows}})
    EXPECT_EQ(field(fields, name).kind, kind) << name.toStdString();
  EXPECT_EQ(field(fields, "planContrasts").columns.size(), 2u) << "contrasts and limits are one table";
  for (const PlanField& f : fields) {
    if (f.kind == FieldKind::choice || f.kind == FieldKind::boxes || f.kind == FieldKind::name) {
      EXPECT_FALSE(f.words.isEmpty()) << f.label.toStdString();
    }
    if (f.kind == FieldKind::whole) {
      EXPECT_LT(f.low, f.high) << f.label.toStdString();
    }
  }
}

TEST(PlanFields, HaveTheLimitsOnMeasuresAsATable) {
  Plan plan = demo();
  plan.measures.noise = plan.measures.transfer = plan.measures.response = true;
  const auto fields = plan_fields();
  const PlanField& limits = field(fields, "planMeasureLimits");
  ASSERT_EQ(limits.columns.size(), 3u);
  EXPECT_TRUE(limits.columns[0].words.contains("response_time"));

  ASSERT_EQ(limits.entered(plan, "response_time: : 14, transfer_slope: 0.98: 1.02"), "");

  ASSERT_EQ(plan.limits.measures.size(), 2u);
  EXPECT_EQ(plan.limits.measures[0].measure, "response_time");
  EXPECT_EQ(plan.limits.measures[0].at_least, std::nullopt);
  EXPECT_EQ(plan.limits.measures[0].at_most, 14);
  EXPECT_EQ(plan.limits.measures[1].at_least, 0.98);
  EXPECT_EQ(limits.shown(plan), "response_time: : 14, transfer_slope: 0.98: 1.02");
  const Plan before = plan;
  EXPECT_NE(limits.entered(plan, "speed: : 14"), "");
  EXPECT_NE(limits.entered(plan, "netd: : much"), "");
  EXPECT_NE(limits.entered(plan, "netd: 1: 2: 3"), "");
  EXPECT_EQ(to_toml(plan), to_toml(before));
  EXPECT_EQ(limits.entered(plan, ""), "");
  EXPECT_TRUE(plan.limits.measures.empty());
}

TEST(PlanFields, HaveZonesOfPixelLimitsAndEarlierUnitsAsTables) {
  Plan plan = demo();
  plan.measures.noise = plan.measures.pixels = true;
  const auto fields = plan_fields();
  const PlanField &zones = field(fields, "planZoneLimits"), &fleets = field(fields, "planFleets");
  ASSERT_EQ(zones.columns.size(), 6u);
  ASSERT_EQ(fleets.columns.size(), 7u);
  EXPECT_EQ(fleets.columns[1].title, "Delta t (K)");

  ASSERT_EQ(zones.entered(plan, "middle: \"0.25, 0.25, 0.75, 0.75\": 0: : 2, whole: : 40"), "");
  ASSERT_EQ(
      fleets.entered(plan, "acuity: 2: 0.6: 0.05: 0.01: 24: \"lot 7: \"\"A\"\", 2025\", netd: : 0.05: 0.004: : 24"),
      "");

  ASSERT_EQ(plan.limits.zones.size(), 2u);
  EXPECT_EQ(plan.limits.zones[0].name, "middle");
  EXPECT_EQ(plan.limits.zones[0].area[2], 0.75);
  EXPECT_EQ(plan.limits.zones[0].bad_pixels, 0);
  EXPECT_EQ(plan.limits.zones[0].substituted_pixels, std::nullopt);
  EXPECT_EQ(plan.limits.zones[0].clusters, 2);
  EXPECT_EQ(plan.limits.zones[1].bad_pixels, 40);
  ASSERT_EQ(plan.limits.fleets.size(), 2u);
  EXPECT_EQ(plan.limits.fleets[0].source, "lot 7: \"A\", 2025");
  EXPECT_EQ(plan.limits.fleets[1].u, FleetRow{}.u);
  EXPECT_TRUE(PlanForm(plan).right());
  for (const PlanField* table : {&zones, &fleets}) {
    Plan again = plan;
    EXPECT_EQ(table->entered(again, table->shown(plan)), "");
    EXPECT_EQ(to_toml(again), to_toml(plan)) << table->shown(plan).toStdString();
  }
  const Plan before = plan;
  EXPECT_NE(zones.entered(plan, "left: half: 1"), "");
  EXPECT_NE(fleets.entered(plan, "netd: : 0.05: wide"), "");
  EXPECT_EQ(to_toml(plan), to_toml(before));
  ASSERT_EQ(zones.entered(plan, "left: \"0, 0, 0.5\": 1"), "");
  EXPECT_FALSE(PlanForm(plan).right());
}

TEST(PlanFields, KeepALimitAtTheContrastThatItWasWrittenWith) {
  Plan plan = demo();
  plan.limits.acuity = {{16.92, 0.4}};  // within the half per cent that counts as equal
  const auto fields = plan_fields();
  const PlanField& contrasts = field(fields, "planContrasts");

  ASSERT_EQ(contrasts.shown(plan), "16.9: 0.4, 1.93: , 0.23: ");
  ASSERT_EQ(contrasts.entered(plan, "0.23, 16.9: 0.5"), "");

  ASSERT_EQ(plan.limits.acuity.size(), 1u);
  EXPECT_EQ(plan.limits.acuity[0].delta_t_k, 16.92);
  EXPECT_EQ(plan.limits.acuity[0].least_acuity_per_mrad, 0.5);
  EXPECT_EQ(plan.target.delta_t_k, (std::vector<double>{0.23, 16.9}));
}

std::size_t line_named(const PlanForm& form, const QString& name) {
  for (std::size_t i = 0; i < form.fields().size(); ++i) {
    if (form.fields()[i].object_name == name) return i;
  }
  ADD_FAILURE() << "no line " << name.toStdString();
  return 0;
}

TEST(PlanForm, TakesLinesThatNeedEachOtherOneAfterTheOther) {
  Plan plan = demo();
  plan.target.kind = TargetKind::prompt;
  plan.target.black_body.clear();
  plan.target.stage.clear();
  PlanForm form(plan);
  const std::size_t kind = line_named(form, "planTarget"), body = line_named(form, "planBlackBody"),
                    stage = line_named(form, "planStage");
  ASSERT_TRUE(form.right());

  form.enter(kind, "scpi");
  EXPECT_FALSE(form.right());
  EXPECT_NE(form.problem(body), "");
  EXPECT_EQ(form.problem(kind), "");
  form.enter(body, "10.0.0.1:5025");
  EXPECT_EQ(form.problem(body), "");
  EXPECT_FALSE(form.right());
  form.enter(stage, "10.0.0.1:5026");
  EXPECT_TRUE(form.right());
  EXPECT_EQ(form.draft().target.kind, TargetKind::scpi);
}

TEST(PlanForm, KeepsWhatCannotBeReadWhenThePlanChangesElsewhere) {
  Plan plan = demo();
  PlanForm form(plan);
  const std::size_t distance = line_named(form, "planDistance");

  form.enter(distance, "far");
  plan.target.phases = 9;
  form.rebase(plan);

  EXPECT_EQ(form.text(distance), "far");
  EXPECT_NE(form.problem(distance), "");
  EXPECT_EQ(form.draft().target.phases, 9);
  form.reset(plan);
  EXPECT_EQ(form.text(distance), "2");
  EXPECT_TRUE(form.right());
}

TEST(PlanForm, PutsTheErrorOfTheBenchBesideItsLine) {
  PlanForm form(demo());
  const std::size_t observer = line_named(form, "planObserver");

  form.refused({ErrorCode::invalid_input, "all of it", ErrorKey{"observer.name", "no such file"}});
  EXPECT_EQ(form.problem(observer), "no such file");
  form.refused({ErrorCode::invalid_input, "of no line", ErrorKey{"target.settle_timeout_s", "x"}});
  EXPECT_EQ(form.other_problems(), QStringList{"of no line"});
}

TEST(PlanFields, PutLimitsAndAnEmptyMarginIntoThePlan) {
  const auto fields = plan_fields();
  Plan plan = demo();

  EXPECT_EQ(field(fields, "planContrasts").entered(plan, "16.9: 0.4, 1.93, 0.23: 0.2"), "");
  EXPECT_EQ(field(fields, "planMargin").entered(plan, ""), "");

  ASSERT_EQ(plan.limits.acuity.size(), 2u);
  EXPECT_EQ(plan.limits.acuity[1].delta_t_k, 0.23);
  EXPECT_EQ(plan.limits.acuity[1].least_acuity_per_mrad, 0.2);
  EXPECT_FALSE(plan.limits.equivalence_margin_percent);
}

TEST(PlanFields, OfAMeasureThatIsOffHaveNoEffect) {
  const auto idle = [](std::string_view path, const Plan& plan) {
    for (const PlanField& field : plan_fields()) {
      if (!field.paths.empty() && field.paths.front() == path) return !idle_reason(field, plan).isEmpty();
    }
    ADD_FAILURE() << path;
    return false;
  };
  Plan plan;
  EXPECT_TRUE(idle("measures.noise_frames", plan));
  EXPECT_TRUE(idle("measures.response_steps", plan));
  EXPECT_TRUE(idle("measures.source_size_px", plan));
  EXPECT_FALSE(idle("measures.source_size", plan)) << "switches it on";
  EXPECT_FALSE(idle("measures.gain_control", plan));

  plan.measures.pixels = plan.measures.gain_control = plan.measures.source_size = true;
  EXPECT_FALSE(idle("measures.noise_frames", plan)) << "the pixel search uses them";
  EXPECT_FALSE(idle("measures.response_steps", plan)) << "the gain is described after the same steps";
  EXPECT_FALSE(idle("measures.source_size_px", plan));
}

}  // namespace
}  // namespace todbench
