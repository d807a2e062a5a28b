// The real window, without a screen, with a simulated camera.
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QProcess>
#include <QSettings>
#include <QTableWidget>
#include <QThread>
#include <QTimer>
#include <cmath>
#include <ctime>

#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plot_view.h"
#include "bench/text/text.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tests/bench/gui/watched_application.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

TEST(WatchedApplication, SeesAnEventThatBlocksOrWorksForLong) {
  const auto longest_of = [](const std::function<void()>& work) {
    WatchedApplication::reset();
    bool done = false;
    QTimer::singleShot(0, qApp, [&] {
      work();
      done = true;
    });
    EXPECT_TRUE(wait_until([&] { return done; }));
    return WatchedApplication::longest_ms();
  };

  EXPECT_GT(longest_of([] { QThread::msleep(60); }), 50) << "blocked";
  EXPECT_GT(longest_of([] {
              timespec now{};
              const auto used_ms = [&] {
                clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
                return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
              };
              for (const double begin = used_ms(); used_ms() < begin + 60;) {
              }
            }),
            50)
      << "busy";
  EXPECT_LT(longest_of([] {}), 50);
}

TEST(Window, ListsTheEmulatedLaboratoryFromTheStart) {
  ShownWindow window("sim:sc2000");

#ifdef TODBENCH_WITH_ARAVIS
  EXPECT_EQ(window->bench().devices().front().id, QString(emulated_laboratory));
#endif
  EXPECT_FALSE(window->bench().devices().empty());
}

TEST(Window, ReachesEveryViewByKeyboard) {
  ShownWindow window("sim:sc2000");
  window->activateWindow();

  int number = 0;
  for (const View view : all_views) {
    ++number;
    QTest::keyClick(&*window, static_cast<Qt::Key>(Qt::Key_0 + number), Qt::ControlModifier);
    EXPECT_TRUE(wait_until([&] { return window->view() == view; }, 5000)) << name_of(view).toStdString();
  }
}

TEST(Window, FitsIntoASmallScreen) {
  ShownWindow window("sim:sc2000");

  for (const View view : all_views) {
    window->show_view(view);
    QApplication::processEvents();
    // 1366 x 768 less a task bar.
    EXPECT_LE(window->minimumSizeHint().width(), 1366) << name_of(view).toStdString();
    EXPECT_LE(window->minimumSizeHint().height(), 728) << name_of(view).toStdString();
  }
}

TEST(Window, ShowsTheLivePictureWithCountsAndKelvinUnderTheCursor) {
  ShownWindow window("sim:sc2000");

  window.click("startLooking");
  ASSERT_TRUE(wait_until([&] { return window->look().latest().has_value(); }));
  auto& picture = window.part<PictureView>("livePicture");
  picture.set_zoom(1);
  QTest::mouseMove(&picture, QPoint(picture.width() / 2, picture.height() / 2));
  emit picture.hovered(160, 120);

  EXPECT_EQ(picture.image().size(), QSize(320, 240));
  const auto reading = window->look().reading(160, 120);
  ASSERT_TRUE(reading && reading->kelvin);
  EXPECT_EQ(reading->counts, window->look().latest()->frame.counts(120, 160));
  EXPECT_THAT(window.part<QLabel>("pixelReading").text().toStdString(), HasSubstr("column 160, row 120"));
  EXPECT_THAT(window.part<QLabel>("pixelReading").text().toStdString(), HasSubstr(" K"));
  window.click("startLooking");
  EXPECT_TRUE(wait_until([&] { return window->bench().activity() == Activity::idle; }));
}

TEST(Window, PlotsExactlyWhatTheSessionHolds) {
  ShownWindow window("sim:sc2000", 8);

  window.measure();

  const auto session = read_session(window->measure().folder());
  ASSERT_TRUE(session && session->curve && session->twin);
  const auto points = window.part<PlotView>("todPlot").points("measured");
  ASSERT_EQ(points.size(), static_cast<qsizetype>(session->curve->points.size()));
  for (qsizetype i = 0; i < points.size(); ++i) {
    const TodPoint& point = session->curve->points[static_cast<std::size_t>(i)];
    ASSERT_TRUE(point.fit.threshold);
    EXPECT_EQ(points[i].x(), 1 / *point.fit.threshold);
    EXPECT_EQ(points[i].y(), point.delta_t_k);
  }
  EXPECT_EQ(window.part<PlotView>("todPlot").points("simulated").size(), points.size());
  double trials = 0, correct = 0;
  for (const auto& level : session->curve->points.front().levels) {
    trials += level.total;
    correct += level.correct;
  }
  const auto proportions = window.part<PlotView>("psychometricPlot0").points("measured");
  EXPECT_EQ(proportions.size(), 5);  // sizes on the plate
  double sum = 0;
  for (const auto& p : proportions) sum += p.y();
  EXPECT_NEAR(sum / 5, correct / trials, 1e-12);  // as many triangles of every size
}

TEST(Window, ZoomsAndMovesAPlotByKeyboard) {
  Plot plot;
  plot.x.scale = AxisScale::logarithmic;
  plot.x.low = 1;
  plot.x.high = 10;
  plot.y.low = 0;
  plot.y.high = 1;
  PlotView view;
  view.show_plot(plot);

  QTest::keyClick(&view, Qt::Key_Right);
  EXPECT_NEAR(view.xAxis->range().lower, std::pow(10, 0.1), 1e-12);  // a tenth of the decade
  EXPECT_NEAR(view.xAxis->range().upper, std::pow(10, 1.1), 1e-12);
  QTest::keyClick(&view, Qt::Key_Down);
  EXPECT_NEAR(view.yAxis->range().lower, -0.1, 1e-12);
  QTest::keyClick(&view, Qt::Key_Plus);
  EXPECT_NEAR(view.yAxis->range().size(), 0.8, 1e-12);
  QTest::keyClick(&view, Qt::Key_Minus);
  EXPECT_NEAR(view.yAxis->range().size(), 1, 1e-12);
  view.show_plot(plot);
  EXPECT_NEAR(view.yAxis->range().lower, -0.1, 1e-12) << "new data leave the view where it is";
  QTest::keyClick(&view, Qt::Key_0);
  EXPECT_EQ(view.xAxis->range().lower, 1);
  EXPECT_EQ(view.yAxis->range().upper, 1);
}

TEST(Window, SaysWhatIsWrongWithAPlanAndKeepsIt) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::plan);
  auto& edit = window.part<QLineEdit>("planDistance");

  edit.setFocus();
  edit.selectAll();
  QTest::keyClicks(&edit, "-3");
  QTest::keyClick(&edit, Qt::Key_Return);

  EXPECT_THAT(window.part<QLabel>("planProblem").text().toStdString(), HasSubstr("distance_m"));
  EXPECT_EQ(window->bench().plan().target.distance_m, 2);
}

TEST(Window, ComparesTwoSessionsAndWritesBothReports) {
  ShownWindow window("sim:sc2000", 3);
  window.measure();
  const auto first = window->measure().folder();
  Plan plan = window->bench().plan();
  plan.seed = 7;
  window->bench().set_plan(plan);
  window.measure();
  const auto second = window->measure().folder();
  ASSERT_TRUE(wait_until(
      [&] { return window->sessions().current().has_value() && window->sessions().current()->folder == second; }));
  window->show_view(View::report);
  ASSERT_TRUE(wait_until([&] { return window->sessions().sessions().size() == 2; }));

  window->sessions().compare_with(first);
  ASSERT_TRUE(wait_until([&] { return window->sessions().compared_sessions().has_value(); }));
  EXPECT_EQ(window.part<QTableWidget>("ratioTable").rowCount(), 2);
  window.click("exportReports");
  ASSERT_TRUE(wait_until([&] { return !window.part<QLabel>("exportedFiles").text().isEmpty(); }));

  const auto folder = window->sessions().current()->folder;
  EXPECT_TRUE(std::filesystem::exists(folder / "report.pdf"));
  const auto changed = verify_manifest(folder);
  ASSERT_TRUE(changed) << changed.error().message;
  EXPECT_THAT(*changed, ::testing::IsEmpty());

  std::filesystem::remove(folder / "report.pdf");
  EXPECT_EQ(QProcess::execute(TODBENCH_GUI_PROGRAM, {"--report", QString::fromStdString(folder.string())}), 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "report.pdf"));
  EXPECT_EQ(QProcess::execute(TODBENCH_GUI_PROGRAM, {"--report", "no-such-session"}), 2);
}

TEST(Window, MeasuresThePlanOfASessionAgainBitForBit) {
  ShownWindow window("sim:sc2000", 2);
  window.measure();
  const auto first = window->measure().folder();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);

  window.click("measureAgain");
  window.measure();

  const auto one = read_session(first);
  const auto two = read_session(window->measure().folder());
  ASSERT_TRUE(one && two && one->curve && two->curve);
  EXPECT_NE(first, window->measure().folder());
  EXPECT_EQ(one->curve->points.front().fit.threshold, two->curve->points.front().fit.threshold);
}

TEST(Window, ReplaysASessionFromItsFramesByteForByte) {
  ShownWindow window("sim:sc2000", 2);
  Plan plan = window->bench().plan();
  plan.measurement.record_frames = true;
  window->bench().set_plan(plan);
  window.measure();
  const auto first = window->measure().folder();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);

  window.click("replaySession");
  EXPECT_EQ(window->bench().activity(), Activity::replaying);
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));

  ASSERT_TRUE(window->measure().outcome()) << window->measure().phase().toStdString();
  EXPECT_EQ(window->measure().same_as_recorded(), std::optional(true));
  EXPECT_THAT(window.part<QLabel>("measurePhase").text().toStdString(), HasSubstr("byte for byte"));
  EXPECT_NE(window->measure().folder(), first);
  const auto one = read_text_file(first / "trials.csv");
  const auto two = read_text_file(window->measure().folder() / "trials.csv");
  ASSERT_TRUE(one && two);
  EXPECT_EQ(*one, *two);
}

TEST(Window, SaysThatASessionWithoutFramesCannotBeReplayed) {
  ShownWindow window("sim:sc2000", 1);

  window.measure();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);

  EXPECT_FALSE(window.part<QPushButton>("replaySession").isEnabled());
  EXPECT_TRUE(window.part<QPushButton>("measureAgain").isEnabled());
  EXPECT_THAT(window.part<QLabel>("sessionFrames").text().toStdString(), HasSubstr("No frames were recorded"));
}

TEST(Window, RemembersDevicePlanColoursAndTheme) {
  TemporaryFolder folder;
  QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope, QString::fromStdString(folder.path().string()));
  {
    MainWindow window(folder.path(), Memory::remember);
    ASSERT_TRUE(window.bench().select_device("sim:sc2000"));
    Plan plan = window.bench().plan();
    plan.operator_name = "P. Example";
    window.bench().set_plan(plan);
    window.findChild<QComboBox*>("colourMap")->setCurrentIndex(2);
    window.set_theme(Theme::dark);
    window.show();
    window.close();
  }

  MainWindow again(folder.path(), Memory::remember);

  EXPECT_EQ(again.bench().device(), QString("sim:sc2000"));
  EXPECT_EQ(again.bench().plan().operator_name, "P. Example");
  EXPECT_EQ(again.look().colour_map(), all_colour_maps[2]);
  EXPECT_LT(again.palette().color(QPalette::Window).lightness(), 100);
  again.set_theme(Theme::light);
}

TEST(Window, ShowsItselfInLightAndDark) {
  ShownWindow window("sim:sc2000");

  window->set_theme(Theme::dark);
  const QColor dark = window->palette().color(QPalette::Window);
  window->set_theme(Theme::light);
  const QColor light = window->palette().color(QPalette::Window);

  EXPECT_LT(dark.lightness(), 100);
  EXPECT_GT(light.lightness(), 200);
}

}  // namespace
}  // namespace todbench::testing
