// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/bill_rows.h"

#include <gtest/gtest.h>

#include "bench/plan/descriptions.h"

namespace todbench {
namespace {

TEST(BillRows, HaveTheForecastBesideTheOutcomeAndTheSentencesBelow) {
  AccuracyBill bill;
  bill.rows = {{"Changes of the target", 24, "2 set-ups", 25.5}, {"Presentations at 0.5 K", {}, "no interval", {}}};
  bill.total_s = 60;
  bill.forecast_s = 50;
  bill.sentences = {"A sentence."};

  const QList<QStringList> rows = bill_rows(bill);

  EXPECT_EQ(rows, (QList<QStringList>{{"Changes of the target", "24.0", "25.5", "2 set-ups"},
                                      {"Presentations at 0.5 K", "not separate", "–", "no interval"},
                                      {"Total", "60.0", "50.0", ""},
                                      {"Remark", "", "", "A sentence."}}));
}

TEST(BillRows, OfAPlanAreItsForecastOrTheReasonWhyThereIsNone) {
  Plan plan;
  plan.name = "bill";
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";
  plan.simulation.accuracy = "draft";
  EffectPlanner planner;

  const auto seen = forecast(LoadedPlan::load(plan).value(), {}, planner);
  ASSERT_TRUE(seen) << seen.error().message;
  const QList<QStringList> rows = bill_rows(*seen);
  plan.target.kind = TargetKind::scene;
  plan.target.black_body = plan.target.stage = "";
  const auto scene = forecast(LoadedPlan::load(plan).value(), {}, planner);
  ASSERT_TRUE(scene) << scene.error().message;

  ASSERT_TRUE(seen->bill);
  ASSERT_EQ(static_cast<std::size_t>(rows.size()), seen->bill->rows.size() + 1 + seen->bill->sentences.size());
  EXPECT_EQ(rows[0][0], QString::fromUtf8(changes_part.data()));
  EXPECT_EQ(rows[0][1], QString::number(*seen->bill->rows[0].seconds, 'f', 1));
  EXPECT_EQ(bill_rows(*scene),
            (QList<QStringList>{{"Remark", "", "No forecast: a simulated scene takes computing time alone."}}));
}

}  // namespace
}  // namespace todbench
