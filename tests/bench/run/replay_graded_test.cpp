// SPDX-License-Identifier: GPL-3.0-or-later
// A replay of graded answers with the function of the twin, which takes a sanitizer minutes.
#include <gmock/gmock.h>

#include "bench/session/session_folder.h"
#include "tests/bench/run/measured_session.h"

namespace todbench {
namespace {

using testing::content_of;
using ::testing::HasSubstr;

using GradedSession = testing::MeasuredSession;

TEST_F(GradedSession, ReplaysWithTheSameProbabilitiesAndTheFunctionOfTheTwin) {
  plan_.schedule.answers = AnswersChoice::graded;
  plan_.schedule.frames_per_presentation = {3};
  plan_.fit.estimator = EstimatorChoice::twin_shape;
  ASSERT_TRUE(measure("m"));

  const auto replay = replay_session(at("m"), options("r"), {}, {});

  ASSERT_TRUE(replay) << replay.error().message;
  EXPECT_TRUE(replay->same_trials);
  EXPECT_EQ(replay->same_fits, true);
  const auto session = read_session(at("r"));
  ASSERT_TRUE(session) << session.error().message;
  for (const Trial& trial : session->trials) {
    EXPECT_TRUE(trial.probability_correct);
    EXPECT_EQ(trial.frames, 3);
  }
  for (const TodPoint& point : session->curve->points) {
    ASSERT_TRUE(point.fit.twin_shape) << point.set_delta_t_k;
    EXPECT_NEAR(point.fit.twin_shape->size_ratio, 1, 0.1);
    EXPECT_EQ(point.fit.interval, IntervalKind::two_way) << "one set-up";
    EXPECT_TRUE(point.fit.usable());
  }
  EXPECT_THAT(content_of(at("r") / "report.html"),
              HasSubstr("The psychometric function is that of the simulated twin"));
}

}  // namespace
}  // namespace todbench
