// SPDX-License-Identifier: GPL-3.0-or-later
// A window that loses nothing: questions before an end, runs that go on, edits that are used or marked, empty plots,
// lists, help.
#include <QCloseEvent>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QTabWidget>
#include <QTableWidget>
#include <QTextBrowser>
#include <QToolButton>

#include "bench/gui/presenters/bill_rows.h"
#include "bench/gui/views/help_window.h"
#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plot_view.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tests/bench/gui/gui_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

TEST(ForgivingWindow, AsksBeforeARunIsLost) {
  ShownWindow window("sim:sc2000", 1000);
  QStringList questions;
  bool answer = false;
  window->set_confirm([&](const QString& question, const QString&) {
    questions << question;
    return answer;
  });
  window->show_view(View::measure);
  window.click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().trials().size() >= 20; }));

  EXPECT_EQ(faults_at_three_sizes(*window), "");
  EXPECT_FALSE(window->close());
  window.click("abortMeasuring");
  window->show_view(View::start);
  window.click("startDemo");
  EXPECT_EQ(window->measure().state(), RunState::running) << "each answer was no";
  ASSERT_EQ(questions.size(), 3);
  for (const QString& question : questions) EXPECT_THAT(question.toStdString(), HasSubstr("is under way"));
  answer = true;
  window->show_view(View::measure);
  window.click("abortMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));
  EXPECT_TRUE(window->close());
  EXPECT_EQ(questions.size(), 4) << "nothing is lost any more";
}

TEST(ForgivingWindow, GoesOnWithARunThatWasAborted) {
  // Long enough that a busy machine aborts it before its end.
  ShownWindow window("sim:sc2000", 36);
  Plan plan = window->bench().plan();
  plan.measurement.record_frames = true;
  window->bench().set_plan(plan);
  window->show_view(View::measure);
  window.click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().trials().size() >= 40; }));
  window.click("abortMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));
  const auto first = window->measure().folder();
  window->sessions().open(first);
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);
  EXPECT_EQ(faults_at_three_sizes(*window), "");

  window.click("resumeSession");
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));

  ASSERT_TRUE(window->measure().outcome()) << window->measure().phase().toStdString();
  const auto one = read_session(first), whole = read_session(window->measure().folder());
  ASSERT_TRUE(one && whole);
  EXPECT_TRUE(whole->complete()) << window->measure().phase().toStdString();
  EXPECT_NE(window->measure().folder(), first);
  ASSERT_GT(whole->trials.size(), one->trials.size());
  ASSERT_TRUE(wait_until([&] { return window->sessions().current()->folder == window->measure().folder(); }));
  EXPECT_FALSE(window.part<QPushButton>("resumeSession").isEnabled()) << "it is complete";
}

TEST(ForgivingWindow, UsesTheTextOfThePlanAsOneTypesOrMarksIt) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::plan);
  auto& tabs = window.part<QTabWidget>("planTabs");
  tabs.setCurrentIndex(1);
  auto& text = window.part<QPlainTextEdit>("planToml");
  const auto& state = window.part<QLabel>("tomlState");
  const QString before = text.toPlainText();
  text.setFocus();
  const auto replace = [&](const QString& what, const QString& by) {
    QTextCursor at = text.document()->find(what);
    ASSERT_FALSE(at.isNull()) << what.toStdString();
    at.insertText(by);
  };

  replace("distance_m = 2", "distance_m = -2");
  ASSERT_TRUE(wait_until([&] { return state.text().startsWith("✗"); }));
  EXPECT_THAT(state.text().toStdString(), HasSubstr("distance_m"));
  EXPECT_EQ(window->bench().plan().target.distance_m, 2);
  EXPECT_TRUE(text.toPlainText().contains("distance_m = -2")) << "the text stays as it was typed";
  EXPECT_TRUE(tabs.tabText(1).contains("✗")) << "visible from the form, too";
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  QStringList questions;
  window->set_confirm([&](const QString& question, const QString&) {
    questions << question;
    return false;
  });
  window->show_view(View::measure);
  window.click("startMeasuring");
  EXPECT_EQ(window->measure().state(), RunState::idle);
  ASSERT_EQ(questions.size(), 1);
  EXPECT_THAT(questions.front().toStdString(), HasSubstr("not in use"));
  replace("distance_m = -2", "distance_m = 3");
  ASSERT_TRUE(wait_until([&] { return window->bench().plan().target.distance_m == 3; }));
  EXPECT_TRUE(state.text().startsWith("✓"));
}

TEST(ForgivingWindow, OffersTheReportAfterARun) {
  ShownWindow window("sim:sc2000", 1);
  window->show_view(View::measure);
  EXPECT_FALSE(window.part<QPushButton>("showReport").isVisible());

  window.measure();
  EXPECT_EQ(faults_at_three_sizes(*window), "");

  window.click("showReport");
  EXPECT_EQ(window->view(), View::report);
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  ASSERT_TRUE(window->sessions().current()->bill);
  const auto& bill = window.part<QTableWidget>("billTable");
  EXPECT_TRUE(bill.isVisibleTo(&*window));
  EXPECT_EQ(bill.rowCount(), bill_rows(*window->sessions().current()->bill).size());
  EXPECT_FALSE(bill.findItems("Computing", Qt::MatchExactly).isEmpty()) << "the scene is simulated";
}

TEST(ForgivingWindow, OffersToTryAgainOnlyWhatMaySucceed) {
  ShownWindow window("sim:sc2000", 1);
  Plan plan = window->bench().plan();
  plan.simulation.sensor = "no-such-sensor";
  window->bench().set_plan(plan);

  window->show_view(View::measure);
  window.click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window.part<QLabel>("messageText").isVisible(); }));

  EXPECT_FALSE(window.part<QPushButton>("retry").isVisible()) << "the same plan fails again";
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  plan.simulation.sensor = "sc2000";
  window->bench().set_plan(plan);
  EXPECT_FALSE(window.part<QLabel>("messageText").isVisible()) << "the value was changed";

  emit window->bench().trouble("the camera is gone", Remedy::try_again);
  plan.seed += 1;
  window->bench().set_plan(plan);
  EXPECT_TRUE(window.part<QPushButton>("retry").isVisible()) << "the plan was not the reason";
}

TEST(ForgivingWindow, ShowsTheNotesOfARun) {
  ShownWindow window("sim:sc2000", 1);
  Plan plan = window->bench().plan();
  plan.camera.ifov_mrad *= 1.011;
  window->bench().set_plan(plan);
  auto& notes = window.part<QListWidget>("measureNotes");
  window->show_view(View::measure);
  EXPECT_FALSE(notes.isVisible());

  window.measure();

  EXPECT_TRUE(notes.isVisible());
  QStringList shown;
  for (int row = 0; row < notes.count(); ++row) shown << notes.item(row)->text();
  EXPECT_THAT(shown.join("\n").toStdString(), HasSubstr("of sc2000")) << "the IFOV of the plan is not that of the twin";
  EXPECT_EQ(shown.size(), window->measure().notes().size());
  EXPECT_EQ(faults_at_three_sizes(*window), "");
}

TEST(ForgivingWindow, NamesAPredictedCurveThatStandsAlone) {
  ShownWindow window("sim:sc2000");
  Plan plan = window->bench().plan();
  plan.limits = {};
  window->bench().set_plan(plan);
  ASSERT_TRUE(wait_until([&] { return window->plan().expected_known(); }));

  window->show_view(View::measure);

  EXPECT_THAT(window.part<PlotView>("todPlot").shown().x.label, HasSubstr("predicted"));
}

TEST(ForgivingWindow, ShowsTheLivePictureBesideARequest) {
  ShownWindow window("sim:sc2000", 1);
  Plan plan = window->bench().plan();
  plan.target.kind = TargetKind::prompt;
  window->bench().set_plan(plan);
  window->show_view(View::measure);
  window.click("startMeasuring");
  const auto& request = window.part<QLabel>("operatorRequest");
  ASSERT_TRUE(wait_until([&] { return request.text().startsWith("Request 1 of "); }));
  EXPECT_EQ(faults_at_three_sizes(*window), "");

  window.click("operatorDone");  // nobody has put a plate in

  ASSERT_TRUE(wait_until([&] { return request.text().contains("The picture contradicts the last request"); }));
  EXPECT_TRUE(request.text().startsWith("Request 1 of ")) << request.text().toStdString();
  EXPECT_FALSE(window.part<PictureView>("operatorPicture").image().isNull());
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  window.click("abortMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));
}

TEST(ForgivingWindow, GivesPlotsWithoutDataTheirWholeWidth) {
  for (const int width : {360, 800, 1600}) {
    PlotView plot;
    plot.resize(width, 260);
    plot.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&plot));
    Plot empty;
    empty.x.low = empty.y.low = 0;
    empty.x.high = empty.y.high = 1;
    plot.show_plot(empty);
    plot.replot();
    EXPECT_GT(plot.axisRect()->width(), 0.8 * width - 40) << width;
  }
}

TEST(ForgivingWindow, KeepsItsWidthWithTheTargetsOfEverySet) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::human);
  window.part<QComboBox>("humanQuestion").setCurrentIndex(1);
  auto& sets = window.part<QComboBox>("humanSet");
  window.part<QLineEdit>("humanRanges").setText("300, 900");
  for (int i = 0; i < sets.count(); ++i) {
    sets.setCurrentIndex(i);
    window.click("beginHuman");
    ASSERT_TRUE(wait_until([&] { return window.part<QPushButton>("endHuman").isEnabled(); }))
        << sets.currentText().toStdString();
    QApplication::processEvents();
    EXPECT_LE(window->minimumSizeHint().width(), 1280) << sets.currentText().toStdString();
    EXPECT_LE(window->minimumSizeHint().height(), 690) << sets.currentText().toStdString();
    window.click("endHuman");
  }
}

TEST(ForgivingWindow, SortsTheSessionsByAColumn) {
  ShownWindow window("sim:sc2000", 1);
  window.measure();
  Plan plan = window->bench().plan();
  plan.unit = "another unit";
  window->bench().set_plan(plan);
  window.measure();
  window->show_view(View::report);
  auto& table = window.part<QTableWidget>("sessionTable");
  ASSERT_TRUE(wait_until([&] { return table.rowCount() == 2; }));

  table.horizontalHeader()->setSortIndicator(2, Qt::AscendingOrder);
  const QString first = table.item(0, 2)->text(), second = table.item(1, 2)->text();
  EXPECT_LT(first, second);
  table.horizontalHeader()->setSortIndicator(2, Qt::DescendingOrder);
  EXPECT_EQ(table.item(0, 2)->text(), second);
  EXPECT_EQ(table.item(1, 2)->text(), first);
  EXPECT_EQ(faults_at_three_sizes(*window), "");
}

TEST(ForgivingWindow, SaysThatThereIsNoPdf) {
  ShownWindow window("sim:sc2000", 1);
  window.measure();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);
  window.click("exportReports");
  ASSERT_TRUE(wait_until([&] { return window.part<QPushButton>("showPdf").isEnabled(); }));
  std::filesystem::remove(window->sessions().current()->folder / "report.pdf");

  window.click("showPdf");

  ASSERT_TRUE(window.part<QLabel>("messageText").isVisible());
  EXPECT_THAT(window.part<QLabel>("messageText").text().toStdString(), HasSubstr("/report.pdf does not exist"));
  EXPECT_EQ(faults_at_three_sizes(*window), "");
}

TEST(ForgivingWindow, PutsTheOrderOnTheFirstPageAndKeepsIt) {
  ShownWindow window("sim:sc2000", 1);
  window.measure();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  const auto file = window.sessions() / "order.toml";
  ASSERT_TRUE(write_file_atomically(file, "[order]\ncustomer = \"Example <Ltd>\"\nreport_number = \"R-17\"\n"));

  window->sessions().export_with_order(file);
  ASSERT_TRUE(wait_until([&] { return !window.part<QLabel>("exportedFiles").text().isEmpty(); }));

  window->show_view(View::report);
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  const auto folder = window->sessions().current()->folder;
  const auto page = read_text_file(folder / "report.html");
  ASSERT_TRUE(page);
  EXPECT_LT(page->find("Example &lt;Ltd&gt;"), page->find("Unit under test"));
  EXPECT_THAT(*page, HasSubstr("R-17"));
  EXPECT_THAT(*page, HasSubstr("Judged by:"));
  const auto again = read_opened_session(folder);
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_TRUE(again->report.order);
  EXPECT_EQ(again->report.order->report_number, "R-17");
}

TEST(ForgivingWindow, ShowsItsPagesWithoutANetwork) {
  ShownWindow window("sim:sc2000");
  window->activateWindow();
  QTest::keyClick(&*window, Qt::Key_F1);
  ASSERT_TRUE(wait_until([&] { return window->findChild<HelpWindow*>() != nullptr; }));
  auto& help = *window->findChild<HelpWindow*>();
  EXPECT_TRUE(help.isVisible());
  EXPECT_THAT(help.browser().toPlainText().toStdString(), HasSubstr("todbench-gui"));

  for (const char* page : {"guide/first-hour.md", "glossary.md", "guide/read-a-report.md", "index.md"}) {
    help.show_page(page);
    EXPECT_GT(help.browser().toPlainText().size(), 500) << page;
  }
}

TEST(ForgivingWindow, FoldsTheSectionsOfTheFormAndGreysLinesWithoutEffect) {
  ShownWindow window("sim:sc2000");
  window->show_view(View::plan);
  auto& line = window.part<QLineEdit>("planBlackBody");
  EXPECT_TRUE(line.property("idle").toBool()) << "a simulated scene has no instruments";
  EXPECT_THAT(line.toolTip().toStdString(), HasSubstr("No effect"));
  EXPECT_TRUE(window.part<QLineEdit>("planDistance").isVisible());

  window.part<QToolButton>("planSectionTarget").click();
  EXPECT_FALSE(window.part<QLineEdit>("planDistance").isVisible());
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  Plan plan = window->bench().plan();
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";
  plan.camera.ifov_mrad = 1.30853994490358127;
  window->bench().set_plan(plan);
  EXPECT_FALSE(line.property("idle").toBool());
  EXPECT_EQ(window.part<QLineEdit>("planIfov").cursorPosition(), 0) << "the beginning of a long number is visible";
}

}  // namespace
}  // namespace todbench::testing
