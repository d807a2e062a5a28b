// SPDX-License-Identifier: GPL-3.0-or-later
// The real window, without a screen, with a simulated camera.
#include <QAbstractSpinBox>
#include <QAccessible>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QDropEvent>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QLocale>
#include <QMenuBar>
#include <QMimeData>
#include <QPlainTextEdit>
#include <QProcess>
#include <QScrollArea>
#include <QScrollBar>
#include <QSettings>
#include <QSpinBox>
#include <QTabWidget>
#include <QTableWidget>
#include <QThread>
#include <QTimer>
#include <algorithm>
#include <cmath>
#include <ctime>

#include "bench/gui/views/human_view.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/page_check.h"
#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plain_numbers.h"
#include "bench/gui/views/plot_view.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tests/bench/gui/watched_application.h"
#include "tests/support/patience.h"
#include "tests/support/verify_manifest.h"

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
  auto& room = window.part<QScrollArea>("pageRoom");

  for (const QSize size : {QSize(1280, 690), QSize(1024, 700)}) {  // 690: 720 less a title bar
    for (const View view : all_views) {
      window->resize(size);
      window->show_view(view);
      QApplication::processEvents();
      EXPECT_EQ(window->size(), size) << name_of(view).toStdString();
      EXPECT_EQ(room.verticalScrollBar()->maximum(), 0) << name_of(view).toStdString() << " at " << size.width();
      // A narrow screen scrolls a wide page to the side, by less than half of its width.
      EXPECT_LE(room.horizontalScrollBar()->maximum(), size.width() < 1280 ? size.width() / 2 : 0)
          << name_of(view).toStdString() << " at " << size.width();
    }
  }
}

TEST(Window, ShowsEveryRowOfALongTableOfLimits) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::report);
  QList<QStringList> rows;
  for (int row = 0; row < 14; ++row)
    rows << QStringList{"Acuity at 16.9 K at least 0.4 1/mrad", "0.478 [0.462, 0.496] 1/mrad", "? inconclusive",
                        "95 % interval 0.4618 to 0.4957 1/mrad: contains the limit"};
  auto& table = window.part<QTableWidget>("limitTable");
  auto& results = window.part<QScrollArea>("sessionResults");

  for (const QSize size : {QSize(1024, 700), QSize(1280, 690), QSize(1920, 1080)}) {
    window->resize(size);
    fill_table(table, rows);

    EXPECT_TRUE(wait_until([&] { return table.verticalScrollBar()->maximum() == 0; }, 5000))
        << "the page scrolls, not the table";
    EXPECT_THAT(faults_of(*window).join("; ").toStdString(), ::testing::Not(HasSubstr("limitTable")));
    EXPECT_TRUE(wait_until(
        [&] {
          results.verticalScrollBar()->setValue(results.verticalScrollBar()->maximum());
          return table.visibleRegion().boundingRect().bottom() == table.height() - 1;
        },
        5000))
        << "its last row can be reached at " << size.width();
  }
}

TEST(Window, CutsNoTextOffFromASmallScreenToALargeOne) {
  ShownWindow window("sim:sc2000");
  ASSERT_TRUE(wait_until([&] { return window->plan().forecast_current(); }));

  for (const QSize size : {QSize(1024, 700), QSize(1280, 690), QSize(1920, 1040), QSize(3840, 2120)}) {
    window->resize(size);
    for (int view = 0; view <= static_cast<int>(View::start); ++view) {
      window->show_view(static_cast<View>(view));
      QApplication::processEvents();
      EXPECT_EQ(window->size(), size);
      QStringList faults = faults_of(*window);
      // Nothing runs yet: pictures and plots are empty.
      faults.removeIf(
          [](const QString& fault) { return fault.endsWith("empty picture") || fault.endsWith("empty plot"); });
      EXPECT_EQ(faults.join("; ").toStdString(), "")
          << name_of(static_cast<View>(view)).toStdString() << " at " << size.width();
    }
  }
}

TEST(Window, FoldsNeutralEffectsUnlessTheyAreChosen) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::plan);
  ASSERT_TRUE(wait_until([&] { return window->plan().forecast_current(); }));
  auto& table = window.part<QTableWidget>("planEffects");
  auto& unfold = window.part<QCheckBox>("neutralEffects");
  const auto& decisions = window->plan().forecast()->effects.decisions;
  const auto is_neutral = [](const EffectDecision& d) { return d.changes_nothing(); };
  const auto neutral = static_cast<int>(std::count_if(decisions.begin(), decisions.end(), is_neutral));
  ASSERT_GT(neutral, 5);

  for (const auto& d : decisions)
    EXPECT_EQ(table.isRowHidden(static_cast<int>(d.effect)), d.changes_nothing()) << to_string(d.effect);
  EXPECT_EQ(unfold.text(), QString("Show the %1 effects that are neutral in this sensor").arg(neutral));

  unfold.setChecked(true);
  for (const auto& d : decisions) EXPECT_FALSE(table.isRowHidden(static_cast<int>(d.effect))) << to_string(d.effect);
  unfold.setChecked(false);
  const auto chosen = std::find_if(decisions.begin(), decisions.end(), is_neutral)->effect;
  ASSERT_EQ(window->plan().choose(chosen, EffectChoice::skip).toStdString(), "");
  ASSERT_TRUE(wait_until([&] { return window->plan().forecast_current(); }));
  EXPECT_FALSE(table.isRowHidden(static_cast<int>(chosen))) << "a choice by hand stays in sight";
}

TEST(Window, ShowsTheForecastOfTheBillBehindTheEffects) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::plan);
  ASSERT_TRUE(wait_until([&] { return window->plan().forecast_current(); }));

  window.part<QTabWidget>("planPreviewTabs").setCurrentIndex(1);
  QApplication::processEvents();

  const auto& table = window.part<QTableWidget>("planBill");
  EXPECT_TRUE(table.isVisible());
  ASSERT_EQ(table.rowCount(), 1);
  EXPECT_THAT(table.item(0, 2)->text().toStdString(), HasSubstr("a simulated scene takes computing time alone"));
  EXPECT_EQ(faults_at_three_sizes(*window), "");
}

TEST(PageCheck, NamesWhatIsCutOffEmptyOrAnError) {
  QWidget page;
  page.resize(400, 400);
  auto* narrow = new QLabel("a text that is far longer than its place", &page);
  narrow->setObjectName("narrow");
  narrow->setGeometry(0, 0, 40, 20);
  auto* low = new QLabel("a text that needs several lines where it stands", &page);
  low->setObjectName("low");
  low->setWordWrap(true);
  low->setGeometry(0, 30, 80, 12);
  auto* plot = new PlotView(&page);
  plot->setObjectName("plot");
  plot->setGeometry(0, 60, 160, 120);
  auto* table = new QTableWidget(1, 1, &page);
  table->setObjectName("table");
  table->setGeometry(0, 200, 160, 100);
  table->setItem(0, 0, new QTableWidgetItem("a cell that is far wider than its column"));
  auto* wrong = new QLabel("wrong", &page);
  wrong->setProperty("role", "problem");
  wrong->setGeometry(200, 0, 100, 30);
  auto* good = new QLabel("good", &page);
  good->setObjectName("good");
  good->setGeometry(200, 40, 100, 30);
  page.show();
  ASSERT_TRUE(QTest::qWaitForWindowExposed(&page));

  const std::string faults = faults_of(page).join("\n").toStdString();

  for (const char* part : {"narrow: cut off", "low: cut off", "plot: empty", "table: cut off", "error: wrong"})
    EXPECT_THAT(faults, HasSubstr(part));
  EXPECT_THAT(faults, ::testing::Not(HasSubstr("good")));
  for (QWidget* part : {static_cast<QWidget*>(narrow), static_cast<QWidget*>(low), static_cast<QWidget*>(plot),
                        static_cast<QWidget*>(table), static_cast<QWidget*>(wrong)})
    part->hide();
  EXPECT_EQ(faults_of(page).join("; ").toStdString(), "") << "what is hidden is not on the page";
}

TEST(Window, GivesEveryPartThatTakesTheFocusAName) {
  ShownWindow window("sim:sc2000");

  int named = 0;
  for (QWidget* part : window->findChildren<QWidget*>()) {
    if (part->focusPolicy() == Qt::NoFocus || part->focusProxy() != nullptr) continue;
    // Parts of parts: a box for numbers and a table speak for them.
    if (part->objectName().startsWith("qt_") || qobject_cast<QAbstractSpinBox*>(part->parentWidget()) != nullptr ||
        qobject_cast<QHeaderView*>(part) != nullptr || qobject_cast<QScrollBar*>(part) != nullptr ||
        part->parentWidget()->inherits("QComboBoxPrivateContainer") || qobject_cast<QMenu*>(part) != nullptr ||
        qobject_cast<QMenuBar*>(part) != nullptr)
      continue;
    // Pages only take it for their keys.
    if (qobject_cast<HumanView*>(part) != nullptr) continue;
    const auto* accessible = QAccessible::queryAccessibleInterface(part);
    const QString name = accessible == nullptr ? part->accessibleName() : accessible->text(QAccessible::Name);
    EXPECT_FALSE(name.isEmpty()) << part->metaObject()->className() << " " << part->objectName().toStdString()
                                 << " below " << part->parentWidget()->metaObject()->className();
    ++named;
  }
  EXPECT_GT(named, 60);
}

TEST(Window, OpensPlansAndSessionsThatAreDroppedOnIt) {
  ShownWindow window("sim:sc2000", 1);
  window.measure();
  const auto session = window->measure().folder();
  Plan other = window->bench().plan();
  other.name = "dropped";
  const auto file = window.sessions() / "dropped.toml";
  ASSERT_TRUE(write_file_atomically(file, to_toml(other)));
  const auto drop = [&](const std::filesystem::path& path) {
    QMimeData data;
    data.setUrls({QUrl::fromLocalFile(QString::fromStdString(path.string()))});
    QDropEvent event(QPointF(300, 300), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    static_cast<QObject&>(*window).event(&event);
  };
  window->show_view(View::look);

  drop(file);
  EXPECT_EQ(window->view(), View::plan);
  EXPECT_EQ(window->bench().plan().name, "dropped");
  window->show_view(View::look);
  drop(session / "session.toml");
  EXPECT_EQ(window->view(), View::report);
  EXPECT_TRUE(
      wait_until([&] { return window->sessions().current() && window->sessions().current()->folder == session; }));
}

TEST(Window, OffersThreeWaysToBegin) {
  ShownWindow window("sim:sc2000");

  window->show_view(View::start);
  window.click("startCamera");
  EXPECT_EQ(window->view(), View::look);
  window->show_view(View::start);
  window.click("startDemo");
  EXPECT_EQ(window->view(), View::measure);
  EXPECT_EQ(window->bench().device(), window->bench().devices().front().id);
  EXPECT_TRUE(window.part<QLabel>("nextStep").isVisible());
}

TEST(Window, FillsInAPlanWithThePartThatEachValueAsksFor) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::plan);
  const auto plan = [&]() -> const Plan& { return window->bench().plan(); };
  const std::string before = to_toml(plan());

  auto& table = window.part<QTableWidget>("planContrasts");
  ASSERT_EQ(table.rowCount(), 2);
  table.item(0, 1)->setText("0.5");
  ASSERT_EQ(plan().limits.acuity.size(), 2u);
  EXPECT_EQ(plan().limits.acuity[0].least_acuity_per_mrad, 0.5);
  table.setCurrentCell(1, 0);
  window.part<QPushButton>("planContrastsRemove").click();
  EXPECT_EQ(plan().target.delta_t_k, std::vector<double>{16.9});
  EXPECT_EQ(plan().limits.acuity.size(), 1u) << "the limit goes with its contrast";
  window.part<QCheckBox>("planMountings_rotated_180").click();
  EXPECT_EQ(plan().target.mountings, (std::vector<Mounting>{Mounting::identity, Mounting::rotated_180}));
  window.part<QSpinBox>("planPhases").setValue(7);
  EXPECT_EQ(plan().target.phases, 7);
  window.part<QCheckBox>("planRecord").click();
  EXPECT_TRUE(plan().measurement.record_frames);

  for (int change = 0; change < 5; ++change) window.part<QPushButton>("undoPlan").click();
  EXPECT_EQ(plan().limits.acuity.size(), 2u);
  EXPECT_EQ(plan().target.mountings, std::vector<Mounting>{Mounting::identity});
  EXPECT_EQ(table.rowCount(), 2) << "the form follows";
  EXPECT_EQ(to_toml(plan()), before);
}

TEST(Window, ReadsAndWritesNumbersAsPlansDoInEveryLocale) {
  // Where a comma is the decimal sign, "1.500" is a thousand and a half, or was meant as one and a half.
  QLocale::setDefault(QLocale(QLocale::German, QLocale::Germany));
  use_plain_numbers();
  PlainSpinBox box;
  box.setMaximum(1e6);
  box.setDecimals(3);
  const auto accepted = [&](QString text) {
    int place = 0;
    return box.validate(text, place) == QValidator::Acceptable;
  };

  box.setValue(12345.25);
  EXPECT_EQ(box.text(), "12345.250");
  EXPECT_FALSE(accepted("1,500"));
  EXPECT_FALSE(accepted("1,5"));
  EXPECT_TRUE(accepted("1.500"));
  EXPECT_EQ(box.valueFromText("1.500"), 1.5);
  EXPECT_EQ(QLocale().toString(1234.5), "1234.5");
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
  EXPECT_EQ(faults_at_three_sizes(*window), "");
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

  EXPECT_TRUE(window.part<QLabel>("planDistanceProblem").isVisible()) << "beside the line";
  EXPECT_TRUE(window.part<QLabel>("planProblem").isVisible());
  EXPECT_EQ(edit.text(), "-3") << "what was entered stays, to be mended";
  EXPECT_EQ(window->bench().plan().target.distance_m, 2);
  edit.selectAll();
  QTest::keyClicks(&edit, "3");
  QTest::keyClick(&edit, Qt::Key_Return);
  EXPECT_FALSE(window.part<QLabel>("planDistanceProblem").isVisible());
  EXPECT_EQ(window->bench().plan().target.distance_m, 3);
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

/// Exit code and both outputs of the program where there is no window system.
std::pair<int, QString> without_a_screen(const QStringList& arguments) {
  QProcess program;
  QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"}) environment.remove(name);
  program.setProcessEnvironment(environment);
  program.setProcessChannelMode(QProcess::MergedChannels);
  program.start(TODBENCH_GUI_PROGRAM, arguments);
  EXPECT_TRUE(program.waitForFinished(static_cast<int>(testing_support::patience(std::chrono::minutes(1)).count())));
  EXPECT_EQ(program.exitStatus(), QProcess::NormalExit);
  return {program.exitCode(), QString::fromUtf8(program.readAll())};
}

TEST(WindowProgram, TellsHelpAndMistakesWithoutAScreen) {
  const auto [help_code, help] = without_a_screen({"--help"});
  EXPECT_EQ(help_code, 0);
  EXPECT_TRUE(help.contains("--screenshots")) << help.toStdString();
  EXPECT_EQ(without_a_screen({"--version"}).first, 0);
  for (const QStringList& wrong :
       {QStringList{"--sesions", "."}, {"--theme", "purple"}, {"--size", "1366"}, {"--size", "0x700"}, {"a", "b"}}) {
    const auto [code, said] = without_a_screen(wrong);
    EXPECT_EQ(code, 2) << wrong.join(' ').toStdString();
    EXPECT_TRUE(said.trimmed().split('\n').constLast().startsWith("todbench-gui: ")) << said.toStdString();
  }
  const auto [code, said] = without_a_screen({});
  EXPECT_EQ(code, 4);
  EXPECT_TRUE(said.contains("there is no screen")) << said.toStdString();
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

TEST(Window, TakesALetterheadInThePlanAndShowsItOverTheSession) {
  ShownWindow window("sim:sc2000", 1);
  const auto file = window.sessions() / "lab.toml";
  ASSERT_TRUE(write_file_atomically(
      file, "title = \"Acceptance\"\nlines = [\"Example Laboratory <b>\", \"Bench 2\"]\nfoot = \"Example\"\n"));
  window->show_view(View::plan);
  auto& line = window.part<QLineEdit>("planLetterhead");
  const auto enter = [&](const QString& text) {
    line.setFocus();
    line.selectAll();
    QTest::keyClicks(&line, text);
    QTest::keyClick(&line, Qt::Key_Return);
  };
  const auto& problem = window.part<QLabel>("planLetterheadProblem");
  enter("no-such-file.toml");
  EXPECT_FALSE(problem.isHidden());
  EXPECT_THAT(problem.text().toStdString(), HasSubstr("no-such-file.toml"));
  enter(QString::fromStdString(file.string()));
  EXPECT_TRUE(problem.isHidden()) << problem.text().toStdString();
  EXPECT_EQ(window->bench().plan().report.letterhead, file.string());

  window.measure();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);
  EXPECT_TRUE(window.part<QWidget>("sessionLetterhead").isVisible());
  EXPECT_EQ(window.part<QLabel>("sessionLaboratory").text().toStdString(),
            "Acceptance\nExample Laboratory <b> · Bench 2");
  window.click("exportReports");
  ASSERT_TRUE(wait_until([&] { return !window.part<QLabel>("exportedFiles").text().isEmpty(); }));
  const auto page = read_text_file(window->measure().folder() / "report.html");
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, HasSubstr("Example Laboratory &lt;b&gt;"));
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
    EXPECT_EQ(window.view(), View::start) << "the first start";
    window.findChild<QTableWidget*>("trialLog")->setColumnWidth(0, 123);
    window.show();
    window.close();
  }

  MainWindow again(folder.path(), Memory::remember);

  EXPECT_EQ(again.view(), View::look);
  EXPECT_EQ(again.findChild<QTableWidget*>("trialLog")->columnWidth(0), 123);
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
