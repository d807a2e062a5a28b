// SPDX-License-Identifier: GPL-3.0-or-later
// How a run ends on disk when the host is not as a run expects it.
#include "bench/run/session_end.h"

#include <gmock/gmock.h>

#include <memory>

#include "bench/run/fitted_curve.h"
#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;
using ::testing::Contains;
using testing::content_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Plan short_plan() {
  Plan plan;
  plan.target.distance_m = 2;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.target.delta_t_k = {16.9};
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 2;
  plan.fit.estimator = EstimatorChoice::weibull;  // not of the function of the twin, which takes longer than the rest
  return plan;
}

/// Clocks on which every look takes a second; the one on the wall is set by `jump` after the first.
HostClocks set_clocks(seconds jump) {
  const auto passed = std::make_shared<seconds>(0);
  const auto looks = std::make_shared<int>(0);
  constexpr HostClocks::Wall start{seconds(1769862896)};  // 2026-01-31T12:34:56Z
  return {.wall = [=] { return start + *passed + ((*looks)++ > 0 ? jump : seconds(0)); },
          .monotonic = [=] { return nanoseconds(*passed += seconds(1)); }};
}

TEST(ClockThatIsSet, WhileASessionRunsMovesNoTimeOfItAndIsSaid) {
  const testing::TemporaryFolder parent;
  std::vector<std::string> notes;
  const ExperimentListener listener{.on_note = [&](std::string_view note) { notes.emplace_back(note); }};
  const ExperimentOptions options{.folder = parent.path() / "s", .host = {.clocks = set_clocks(seconds(86400))}};

  const auto run = simulate_plan(short_plan(), options, listener, {});

  ASSERT_TRUE(run) << run.error().message;
  const Session session = open_session(run->folder, {}).value();
  EXPECT_THAT(session.provenance.started_utc, StartsWith("2026-01-31T12:34:5"));
  EXPECT_THAT(session.provenance.ended_utc, StartsWith("2026-01-31T12:3"));
  EXPECT_NEAR(session.provenance.clock_jump_s, 86400, 2);
  EXPECT_THAT(notes, Contains(HasSubstr("the clock of the host was changed during the session and is now 8640")));
  EXPECT_THAT(content_of(run->folder / "report.html"), HasSubstr("the clock of the host was changed"));
  EXPECT_THAT(content_of(run->folder / "log.txt"), HasSubstr("the clock of the host was changed"));
  std::istringstream log(content_of(run->folder / "log.txt"));
  for (std::string line; std::getline(log, line);) EXPECT_THAT(line, StartsWith("2026-01-31T12:3"));
}

TEST(ClockThatIsSet, IsNothingWhereItIsNot) {
  const testing::TemporaryFolder parent;
  const ExperimentOptions options{.folder = parent.path() / "s", .host = {.clocks = set_clocks(seconds(0))}};

  const auto run = simulate_plan(short_plan(), options, {}, {});

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(open_session(run->folder, {})->provenance.clock_jump_s, 0);
}

TEST(SessionEnd, LeavesNothingInTheFolderThatTheManifestDoesNotList) {
  const testing::TemporaryFolder parent;

  const auto run = simulate_plan(short_plan(), {.folder = parent.path() / "s"}, {}, {});

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_TRUE(check_manifest(run->folder)->intact());
}

// The answers of a contrast are then those of a part of the ramp, and their function is not that of one contrast.
TEST(RampThatEndedEarly, HasNoThresholds) {
  Plan plan;
  plan.schedule.kind = ScheduleKind::ramp;
  const std::vector<Level> levels{{1, 10, 40}, {2, 30, 40}, {3, 39, 40}};
  TodCurve curve;
  TodPoint& point = curve.points.emplace_back();
  point.set_delta_t_k = 11, point.delta_t_k = 10, point.levels = levels;
  point.fit = fit_psychometric(levels, {}).value();
  ASSERT_TRUE(point.fit.usable());
  TwinShapesOutcome said;

  EXPECT_TRUE(take_ramp_of(curve, said, {}, {}, plan).empty());

  EXPECT_FALSE(point.fit.threshold);
  EXPECT_FALSE(point.fit.usable());
  EXPECT_THAT(said.notes, Contains(HasSubstr("the ramp ended early")));
}

}  // namespace
}  // namespace todbench
