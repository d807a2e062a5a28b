// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/measure_presenter.h"
#include "tests/support/verify_manifest.h"

#include <gmock/gmock.h>

#include "bench/devices/pause.h"
#include "bench/session/trials_csv.h"
#include "tests/bench/gui/gui_test_support.h"

namespace todbench {
namespace {

using testing::wait_until;

struct Bench {
  explicit Bench(int phases) {
    EXPECT_TRUE(bench.select_device("sim:sc2000"));
    bench.set_plan(testing::small_plan(bench.plan(), phases));
  }
  ~Bench() { bench.shut_down(); }
  [[nodiscard]] bool idle() const { return presenter.state() == RunState::idle && bench.activity() == Activity::idle; }

  testing::TemporaryFolder folder;
  Workbench bench{folder.path()};
  MeasurePresenter presenter{bench};
};

/// Far more presentations than any test waits for.
constexpr int endless = 10000;

TEST(MeasurePresenter, EndsWithTheCurvesOfTheSessionFolder) {
  Bench b(2);

  b.presenter.start();
  ASSERT_TRUE(wait_until([&] { return b.idle(); }));

  const auto session = read_session(b.presenter.folder());
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_TRUE(session->complete());
  ASSERT_TRUE(session->curve && session->twin && b.presenter.measured() && b.presenter.twin());
  ASSERT_EQ(session->curve->points.size(), b.presenter.measured()->points.size());
  for (std::size_t i = 0; i < session->curve->points.size(); ++i) {
    EXPECT_EQ(session->curve->points[i].fit.threshold, b.presenter.measured()->points[i].fit.threshold);
    EXPECT_EQ(session->twin->points[i].fit.threshold, b.presenter.twin()->points[i].fit.threshold);
  }
  EXPECT_EQ(session->trials.size(), b.presenter.trials().size());
  EXPECT_GT(b.presenter.planned(), 0u);
  EXPECT_EQ(b.presenter.done(), b.presenter.planned());
}

TEST(MeasurePresenter, KeepsThePatchThatWasJudgedForEveryAnswer) {
  Bench b(1);

  b.presenter.start();
  ASSERT_TRUE(wait_until([&] { return b.idle(); }));

  ASSERT_FALSE(b.presenter.trials().empty());
  for (const auto& judged : b.presenter.trials()) {
    EXPECT_EQ(judged.patch_k.rows, judged.patch_k.cols);
    // Kelvin of a room, whatever the triangle's contrast.
    EXPECT_NEAR(judged.patch_k(0, 0), 300, 25);
  }
}

TEST(MeasurePresenter, ShowsCurvesWhileItMeasures) {
  Bench b(endless);

  b.presenter.start();
  const bool curve = wait_until([&] { return b.presenter.measured() && !b.presenter.measured()->points.empty(); });
  const RunState state = b.presenter.state();
  b.presenter.abort();

  EXPECT_TRUE(curve);
  EXPECT_EQ(state, RunState::running);
  EXPECT_TRUE(wait_until([&] { return b.idle(); }));
}

TEST(MeasurePresenter, TakesNoAnswerWhilePausedAndGoesOnAfterwards) {
  Bench b(endless);
  b.presenter.start();
  ASSERT_TRUE(wait_until([&] { return b.presenter.trials().size() >= 40; }));

  b.presenter.pause();
  // What was under way when the pause came arrives; then the count stands.
  std::size_t before = 0;
  ASSERT_TRUE(wait_until([&] {
    const std::size_t now = b.presenter.trials().size();
    const bool stands = now == before;
    before = now;
    QTest::qWait(300);
    return stands;
  }));
  QTest::qWait(300);
  EXPECT_EQ(b.presenter.trials().size(), before);
  b.presenter.resume();

  EXPECT_TRUE(wait_until([&] { return b.presenter.trials().size() > before; }));
  b.presenter.abort();
  EXPECT_TRUE(wait_until([&] { return b.idle(); }));
}

/// Where a run is when it is aborted.
struct AbortCase {
  const char* name;
  int phases;
  std::function<bool(MeasurePresenter&)> reached;
};

void PrintTo(const AbortCase& abort, std::ostream* out) {
  *out << abort.name;
}

class Abort : public ::testing::TestWithParam<AbortCase> {};

TEST_P(Abort, EndsTheRunAndLeavesAValidSessionOrNone) {
  Bench b(GetParam().phases);
  b.presenter.start();
  ASSERT_TRUE(wait_until([&] { return GetParam().reached(b.presenter); }));

  b.presenter.abort();

  ASSERT_TRUE(wait_until([&] { return b.idle(); }));
  for (const auto& entry : std::filesystem::directory_iterator(b.folder.path())) {
    const auto session = read_session(entry.path());
    ASSERT_TRUE(session) << session.error().message;
    EXPECT_EQ(session->provenance.state, SessionState::interrupted);
    const auto changed = verify_manifest(entry.path());
    ASSERT_TRUE(changed) << changed.error().message;
    EXPECT_THAT(*changed, ::testing::IsEmpty());
  }
  b.presenter.start();
  EXPECT_TRUE(wait_until([&] { return !b.presenter.trials().empty(); })) << "a run after the aborted one";
  b.presenter.abort();
  EXPECT_TRUE(wait_until([&] { return b.idle(); }));
}

INSTANTIATE_TEST_SUITE_P(
    InEveryState, Abort,
    ::testing::Values(AbortCase{"AtOnce", endless, [](MeasurePresenter&) { return true; }},
                      AbortCase{"BeforeTheFirstAnswer", endless,
                                [](MeasurePresenter& p) { return p.phase().startsWith("measuring"); }},
                      AbortCase{"WhileMeasuring", endless, [](MeasurePresenter& p) { return p.trials().size() >= 40; }},
                      AbortCase{"WhilePaused", endless,
                                [](MeasurePresenter& p) {
                                  if (p.trials().size() >= 20) p.pause();
                                  return p.state() == RunState::paused;
                                }},
                      AbortCase{"InTheTwin", 30,
                                [](MeasurePresenter& p) { return p.phase().startsWith("simulating its twin"); }}),
    [](const ::testing::TestParamInfo<AbortCase>& tested) { return tested.param.name; });

TEST(MeasurePresenter, AsksTheOperatorAndGoesOnWhenTheTargetIsChanged) {
  Bench b(1);
  Plan plan = b.bench.plan();
  plan.target.kind = TargetKind::prompt;
  b.bench.set_plan(plan);

  b.presenter.start();
  ASSERT_TRUE(wait_until([&] { return b.presenter.operator_request().has_value(); }));
  const OperatorRequest request = *b.presenter.operator_request();
  EXPECT_EQ(b.presenter.next_step().count('\n') + 1, static_cast<qsizetype>(request.steps.size())) << "a line a step";
  b.presenter.abort();

  ASSERT_FALSE(request.steps.empty());
  const auto* plate = std::get_if<PutInPlate>(&request.steps.front());
  ASSERT_NE(plate, nullptr);
  EXPECT_EQ(plate->plate, "tcat-a");
  EXPECT_TRUE(wait_until([&] { return b.idle(); })) << "a run that waits for a hand can be aborted";
}

TEST(MeasurePresenter, AsksTheOperatorAgainIfThePictureContradictsTheRequest) {
  Bench b(1);
  Plan plan = b.bench.plan();
  plan.target.kind = TargetKind::prompt;
  b.bench.set_plan(plan);
  b.presenter.start();
  ASSERT_TRUE(wait_until([&] { return b.presenter.operator_request().has_value(); }));
  const QString number = b.presenter.request_number();

  b.presenter.operator_done();  // nobody has put a plate in

  ASSERT_TRUE(wait_until([&] {
    return b.presenter.operator_request() && b.presenter.operator_request()->steps.size() > 2 &&
           std::holds_alternative<CheckAgain>(b.presenter.operator_request()->steps.front());
  }));
  EXPECT_TRUE(b.presenter.next_step().startsWith("The picture contradicts the last request"))
      << b.presenter.next_step().toStdString();
  EXPECT_EQ(b.presenter.request_number(), number) << "the same request";
  b.presenter.abort();
  EXPECT_TRUE(wait_until([&] { return b.idle(); }));
}

TEST(Pause, RestsUntilResumedOrStopped) {
  Pause pause;
  std::stop_source stop;

  EXPECT_FALSE(pause.rest(stop.get_token()));
  pause.pause();
  EXPECT_TRUE(pause.rest(stop.get_token()));
  pause.resume();
  EXPECT_FALSE(pause.rest(stop.get_token()));
}

}  // namespace
}  // namespace todbench
