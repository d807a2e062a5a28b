// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/report_data.h"

#include <gtest/gtest.h>

namespace todbench {
namespace {

/// A curve whose acuity is at least 0.5 1/mrad.
TodCurve clear_curve() {
  TodPoint point;
  point.set_delta_t_k = point.delta_t_k = 16.9;
  point.fit.verdict = FitVerdict::ok;
  point.fit.threshold = 1.8;
  point.fit.ci95 = {1.6, 2.0};
  return {"hvs-1", "sc2000", {point}};
}

/// A finished session whose plan demands 0.4 1/mrad.
Session session_with_limit() {
  Session session;
  session.plan.limits.acuity = {{16.9, 0.4}};
  session.provenance.state = SessionState::complete;
  session.curve = clear_curve();
  return session;
}

TEST(ReportData, ShowsTheStoredVerdictAndJudgesNothingAgain) {
  Session session = session_with_limit();
  session.verdict =
      judge({.limits = {{{16.9, 0.8}}, std::nullopt}, .curve = *session.curve, .comparison = std::nullopt});
  ASSERT_EQ(session.verdict->decision, VerdictKind::fail);

  const Result<ReportData> data = report_data(session, "s");

  ASSERT_TRUE(data) << data.error().message;
  EXPECT_EQ(report_verdict(*data), ReportVerdict::fail);
  EXPECT_EQ(data->verdict->demands.at(0).limit, 0.8);
  const std::string page = render_report(*data);
  EXPECT_NE(page.find("Acuity at 16.9 K at least 0.8 1/mrad"), std::string::npos);
  EXPECT_EQ(page.find("at least 0.4 1/mrad"), std::string::npos);
  EXPECT_EQ(page.find("stored no verdict"), std::string::npos);
}

TEST(ReportData, JudgesAnOldSessionByItsPlanAndSaysSo) {
  const Result<ReportData> data = report_data(session_with_limit(), "s");

  ASSERT_TRUE(data) << data.error().message;
  EXPECT_EQ(report_verdict(*data), ReportVerdict::pass);
  const std::string page = render_report(*data);
  EXPECT_NE(page.find("Acuity at 16.9 K at least 0.4 1/mrad"), std::string::npos);
  EXPECT_NE(page.find("stored no verdict. The session was judged afterwards"), std::string::npos);
}

TEST(ReportData, SaysWhyARunEndedEarlyAsItsVerdictHasIt) {
  Session session = session_with_limit();
  session.provenance.state = SessionState::interrupted;
  session.verdict = judge({.limits = session.plan.limits,
                           .curve = *session.curve,
                           .comparison = std::nullopt,
                           .ended_early = "the simulated twin: stopped on request"});

  const Result<ReportData> data = report_data(session, "s");

  ASSERT_TRUE(data) << data.error().message;
  EXPECT_EQ(report_verdict(*data), ReportVerdict::interrupted);
  EXPECT_EQ(data->interrupted, "the simulated twin: stopped on request");
}

}  // namespace
}  // namespace todbench
