// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/session_presenter.h"

#include <gmock/gmock.h>

#include <array>

#include "bench/gui/presenters/measure_presenter.h"
#include "bench/text/files.h"
#include "tests/bench/gui/gui_test_support.h"

namespace todbench {
namespace {

using testing::wait_until;

struct SessionBench {
  SessionBench() {
    EXPECT_TRUE(bench.select_device("sim:sc2000"));
    QObject::connect(&presenter, &SessionPresenter::problem, [this](const QString& said) { problem = said; });
  }
  ~SessionBench() { bench.shut_down(); }

  std::filesystem::path measure(std::uint64_t seed) {
    Plan plan = testing::small_plan(bench.plan(), 6);
    plan.seed = seed;
    bench.set_plan(plan);
    MeasurePresenter measuring(bench);
    measuring.start();
    EXPECT_TRUE(wait_until([&] { return measuring.state() == RunState::idle && bench.activity() == Activity::idle; }));
    return measuring.folder();
  }

  testing::TemporaryFolder folder;
  Workbench bench{folder.path()};
  SessionPresenter presenter{bench};
  QString problem;
};

TEST(SessionPresenter, ListsOpensAndComparesWhatIsOnDisk) {
  SessionBench b;
  const auto first = b.measure(1), second = b.measure(2);

  b.presenter.refresh();
  ASSERT_TRUE(wait_until([&] { return b.presenter.sessions().size() == 2; }));
  b.presenter.open(first);
  ASSERT_TRUE(wait_until([&] { return b.presenter.current().has_value(); }));
  const auto session = read_session(first);
  ASSERT_TRUE(session && session->curve);
  EXPECT_EQ(b.presenter.current()->session.curve->points.front().fit.threshold,
            session->curve->points.front().fit.threshold);
  EXPECT_FALSE(b.presenter.current()->recorded);

  b.presenter.compare_with(second);
  ASSERT_TRUE(wait_until([&] { return b.presenter.compared_sessions().has_value(); }));
  const auto& compared = *b.presenter.compared_sessions();
  ASSERT_FALSE(compared.comparison.points.empty());
  EXPECT_NEAR(compared.comparison.points.front().ratio.value(),
              *compared.curve_b.points.front().fit.threshold / *compared.curve_a.points.front().fit.threshold, 1e-12);
  EXPECT_EQ(b.problem, "");
}

TEST(SessionPresenter, ListsVerdictAndUnitAndFindsSessionsByTheirWords) {
  const SessionEntry a{{}, "first", "2026-01-02 10:00:00", "complete", "Camera One", "TB0001", "pass"};
  const SessionEntry b{{}, "second", "2026-01-03 10:00:00", "complete", "Camera One", "TB0002", "fail"};
  const auto names = [&](const char* filter) {
    std::string found;
    for (const SessionEntry& s : matching({a, b}, filter)) found += s.name.toStdString() + " ";
    return found;
  };
  EXPECT_EQ(names(""), "first second ");
  EXPECT_EQ(names("tb0002"), "second ");
  EXPECT_EQ(names(" camera  2026-01-02 "), "first ");
  EXPECT_EQ(names("TB0001 fail"), "");

  SessionBench bench;
  Plan plan = bench.bench.plan();
  plan.unit = "unit 17";
  bench.bench.set_plan(plan);
  const auto folder = bench.measure(1);
  const auto session = read_session(folder);
  const auto listed = sessions_below(bench.folder.path());
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0].unit, "unit 17");
  EXPECT_EQ(listed[0].state, "complete");
  EXPECT_FALSE(listed[0].serial.isEmpty());
  EXPECT_THAT((std::array<QString, 3>{"pass", "fail", "inconclusive"}), ::testing::Contains(listed[0].verdict));
  ASSERT_TRUE(write_file_atomically(folder / "verdict.json", "{\"decision\": \"pass\"}"));
  const auto changed = sessions_below(bench.folder.path());
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(changed[0].state, "changed");
  EXPECT_EQ(changed[0].verdict, "") << "nobody vouches for it";
}

TEST(SessionPresenter, ComparesWhatIsStillBeingOpenedAndForgetsNothingThatWasAsked) {
  SessionBench b;
  const auto first = b.measure(1), second = b.measure(2);
  b.presenter.open(first);
  ASSERT_TRUE(wait_until([&] { return b.presenter.current().has_value(); }));

  b.presenter.export_reports();
  b.presenter.open(second);
  b.presenter.compare_with(first);

  ASSERT_TRUE(wait_until([&] { return b.presenter.compared_sessions().has_value(); }));
  EXPECT_EQ(b.presenter.current()->folder, second);
  EXPECT_EQ(b.presenter.compared_sessions()->b, QString::fromStdString(first.filename().string()));
  EXPECT_TRUE(std::filesystem::exists(first / "report.pdf"));
  EXPECT_EQ(b.problem, "");
}

TEST(SessionPresenter, SaysWhatIsWrongWithAFolderAndKeepsWhatIsOpen) {
  SessionBench b;
  const auto folder = b.measure(1);
  b.presenter.open(folder);
  ASSERT_TRUE(wait_until([&] { return b.presenter.current().has_value(); }));

  b.presenter.open(b.folder.path() / "nothing");

  ASSERT_TRUE(wait_until([&] { return !b.problem.isEmpty(); }));
  EXPECT_THAT(b.problem.toStdString(), ::testing::HasSubstr("nothing"));
  EXPECT_EQ(b.presenter.current()->folder, folder);
}

}  // namespace
}  // namespace todbench
