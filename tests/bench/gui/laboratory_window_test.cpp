// SPDX-License-Identifier: GPL-3.0-or-later
// The real window with the emulated laboratory: a GigE camera at 50 Hz, instruments on the network.
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QSlider>
#include <QStatusBar>
#include <QTableWidget>
#include <QTreeWidget>

#include "bench/devices/emulation.h"
#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plot_view.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tests/bench/gui/watched_application.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

void click_item(QTreeWidget& tree, const QString& id) {
  for (QTreeWidgetItemIterator item(&tree); *item != nullptr; ++item) {
    if ((*item)->data(0, Qt::UserRole).toString() != id) continue;
    QTest::mouseClick(tree.viewport(), Qt::LeftButton, {}, tree.visualItemRect(*item).center());
    return;
  }
  FAIL() << "no device " << id.toStdString();
}

TEST(LaboratoryWindow, ThreeClicksToACurve) {
  ShownWindow window("sim:sc2000", 2);

  click_item(window.part<QTreeWidget>("deviceTree"), emulated_laboratory);
  auto& navigation = window.part<QListWidget>("navigation");
  QTest::mouseClick(navigation.viewport(), Qt::LeftButton, {},
                    navigation.visualItemRect(navigation.item(static_cast<int>(View::measure))).center());
  window.click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));

  ASSERT_TRUE(window->measure().outcome()) << window->measure().phase().toStdString();
  const auto session = read_session(window->measure().folder());
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_TRUE(session->complete());
  ASSERT_TRUE(session->provenance.camera);
  EXPECT_EQ(session->provenance.camera->transport, "GigE Vision");
  EXPECT_TRUE(session->comparison);
  EXPECT_EQ(window.part<PlotView>("todPlot").points("measured").size(), 2);
}

TEST(LaboratoryWindow, AlignsThenMeasuresThenComparesAndWritesThePdf) {
  ShownWindow window(emulated_laboratory, 2);

  window->show_view(View::align);
  window.click("startAligning");
  ASSERT_TRUE(wait_until([&] { return window->align().looks() >= 2; }));
  const Alignment alignment = *window->align().alignment();
  ASSERT_TRUE(alignment.registration);
  EXPECT_LT(alignment.registration->residual_px, 0.1);
  EXPECT_NEAR(alignment.registration->rotation_deg, 0.4, 0.05);  // as the laboratory is set up
  EXPECT_THAT(alignment.remarks, ::testing::IsEmpty());
  EXPECT_EQ(alignment.triangles.size(), 20u);
  // The edge of the plate, and outline and window of every triangle.
  EXPECT_EQ(window.part<PictureView>("alignPicture").outlines().size(), 41u);
  window.click("startAligning");
  ASSERT_TRUE(wait_until([&] { return window->bench().activity() == Activity::idle; }));
  EXPECT_EQ(window->statusBar()->currentMessage(), "") << "nothing is aligned any more";
  window.measure();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);
  EXPECT_EQ(window.part<QTableWidget>("ratioTable").rowCount(), 2);
  window.click("exportReports");
  ASSERT_TRUE(wait_until([&] { return !window.part<QLabel>("exportedFiles").text().isEmpty(); }));

  EXPECT_TRUE(std::filesystem::exists(window->measure().folder() / "report.pdf"));
  EXPECT_THAT(window.part<QLabel>("sessionTitle").text().toStdString(), HasSubstr("TB0001"));
}

TEST(LaboratoryWindow, ShowsACameraWithoutATargetAndItsControls) {
  ShownWindow window(emulated_laboratory, 2);
  auto laboratory = start_laboratory(emulation_for(window->bench().plan()));
  ASSERT_TRUE(laboratory) << laboratory.error().message;
  const QString camera = QString::fromStdString((*laboratory)->camera_id());
  // The laboratory is another's; the window's own is not listed twice.
  window->bench().rescan();
  ASSERT_TRUE(wait_until([&] { return window->bench().devices().back().id == camera; }));
  ASSERT_TRUE(window->bench().select_device(emulated_laboratory));
  ASSERT_TRUE(window->bench().select_device(camera));
  Plan plan = window->bench().plan();
  EXPECT_EQ(plan.target.kind, TargetKind::prompt);
  EXPECT_EQ(plan.camera.ifov_mrad, 0);
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";  // nobody's
  window->bench().set_plan(plan);
  QStringList notes;
  QObject::connect(&window->bench(), &Workbench::noted, [&](const QString& sentence) { notes << sentence; });

  window.click("startLooking");
  ASSERT_TRUE(wait_until([&] { return window->look().latest() && notes.join("").contains("without its target"); }));

  auto& rate = window.part<QLineEdit>("cameraFramerate");
  ASSERT_TRUE(wait_until([&] { return rate.isEnabled(); }));
  EXPECT_TRUE(rate.toolTip().contains("AcquisitionFrameRate")) << rate.toolTip().toStdString();
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  window.click("startLooking");
  ASSERT_TRUE(wait_until([&] { return window->bench().activity() == Activity::idle; }));
  EXPECT_EQ(window->bench().devices().back().id, camera);
  EXPECT_EQ(window->bench().devices().back().health, DeviceHealth::ready) << "its target failed, not the camera";
}

TEST(LaboratoryWindow, SaysThatTheCameraIsGoneAndMeasuresAgainWhenAskedTo) {
  ShownWindow window(emulated_laboratory, 1000);
  Plan plan = window->bench().plan();
  plan.camera.reconnect_s = 0;  // nobody switches it on again
  window->bench().set_plan(plan);
  window->show_view(View::measure);
  window.click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().trials().size() >= 40; }));

  window->bench().switch_emulated_camera_off();
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));

  const auto lost = window->measure().folder();
  ASSERT_TRUE(wait_until([&] { return window.part<QLabel>("messageText").isVisible(); }));
  EXPECT_THAT(window.part<QLabel>("messageText").text().toStdString(), HasSubstr("camera"));
  EXPECT_EQ(QApplication::activeModalWidget(), nullptr) << "a message, not a dialog";
  EXPECT_EQ(window->bench().devices().front().health, DeviceHealth::lost);
  const auto session = read_session(lost);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->provenance.state, SessionState::interrupted);
  EXPECT_GE(session->trials.size(), 40u);
  window.click("retry");
  EXPECT_TRUE(wait_until([&] { return window->measure().trials().size() >= 20; })) << "the way back";
  window.click("abortMeasuring");
  EXPECT_TRUE(wait_until([&] { return window->bench().activity() == Activity::idle; }));
}

TEST(LaboratoryWindow, SaysHowLongItWaitsForALostCameraAndOffersTheWaysBack) {
  ShownWindow window(emulated_laboratory, 1000);
  Plan plan = window->bench().plan();
  plan.camera.reconnect_s = 300;
  window->bench().set_plan(plan);
  window->show_view(View::measure);
  window.click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().trials().size() >= 40; }));

  window->bench().switch_emulated_camera_off();
  ASSERT_TRUE(wait_until([&] { return !window->measure().camera_away().isEmpty(); }));

  EXPECT_EQ(window->measure().state(), RunState::running);
  EXPECT_EQ(window->bench().devices().front().health, DeviceHealth::lost);
  const auto& message = window.part<QLabel>("messageText");
  EXPECT_TRUE(message.isVisible());
  EXPECT_THAT(message.text().toStdString(), HasSubstr("TB0001"));
  EXPECT_THAT(message.text().toStdString(), HasSubstr(" s left"));
  EXPECT_FALSE(window.part<QPushButton>("retry").isVisible()) << "nothing to try while it is waited for";
  EXPECT_EQ(QApplication::activeModalWidget(), nullptr) << "a message, not a dialog";
  const QString before = message.text();
  EXPECT_TRUE(wait_until([&] { return message.text() != before; })) << "the time left runs";
  EXPECT_TRUE(window.part<QPushButton>("abandonRun").isVisible());
  window.click("otherCamera");
  EXPECT_EQ(window->view(), View::look);
  ASSERT_TRUE(wait_until([&] { return window->bench().activity() == Activity::idle; }));
  const auto session = read_session(window->measure().folder());
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->provenance.state, SessionState::interrupted);
  EXPECT_FALSE(message.isVisible());
}

TEST(LaboratoryWindow, KeepsTheStreamWholeDuringAPause) {
  ShownWindow window(emulated_laboratory, 1000);
  window->show_view(View::measure);
  window.click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().trials().size() >= 40; }));

  window.click("pauseMeasuring");
  // Far more frames than the queue of the camera holds.
  QTest::qWait(3000);
  const auto before = window->measure().trials().size();
  window.click("pauseMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->measure().trials().size() >= before + 40; }))
      << window.part<QLabel>("messageText").text().toStdString();
  window.click("abortMeasuring");
  ASSERT_TRUE(wait_until([&] { return window->bench().activity() == Activity::idle; }));

  const auto session = read_session(window->measure().folder());
  ASSERT_TRUE(session && session->provenance.run) << "ended with a run";
  EXPECT_THAT(session->provenance.run->ended_by, HasSubstr("stopped"));  // between frames, or while the target settled
}

TEST(LaboratoryWindow, NeverKeepsItsThreadForFiftyMillisecondsWhileItMeasures) {
#ifdef TODBENCH_SANITIZED
  GTEST_SKIP() << "sanitizers make everything slower by a factor that says nothing";
#endif
  ShownWindow window(emulated_laboratory, 8);
  // Fonts and styles are loaded when a view is first shown.
  for (const View view : all_views) {
    window->show_view(view);
    QApplication::processEvents();
  }
  window->show_view(View::look);
  window.click("startLooking");
  ASSERT_TRUE(wait_until([&] { return window->look().latest() && window->look().latest()->counters.good > 25; }));
  window.click("startLooking");
  ASSERT_TRUE(wait_until([&] { return window->bench().activity() == Activity::idle; }));

  WatchedApplication::reset();
  window->show_view(View::measure);
  window.click("startMeasuring");
  // While it measures somebody goes through the views and moves the slider.
  std::size_t step = 0;
  ASSERT_TRUE(wait_until([&] {
    if (step % 10 == 0) window->show_view(all_views[step / 10 % all_views.size()]);
    if (step % 25 == 0) window.part<QSlider>("toleranceSlider").setValue(static_cast<int>(20 + step % 60));
    ++step;
    return window->measure().state() == RunState::idle;
  }));
  ASSERT_TRUE(window->measure().outcome()) << window->measure().phase().toStdString();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);
  window->sessions().export_reports();
  ASSERT_TRUE(wait_until([&] { return !window.part<QLabel>("exportedFiles").text().isEmpty(); }));

  EXPECT_GT(step, 70U) << "every view was shown";
  EXPECT_LT(WatchedApplication::longest_ms(), 50) << WatchedApplication::longest_event().toStdString();
  RecordProperty("longest_ms", std::to_string(WatchedApplication::longest_ms()));
}

}  // namespace
}  // namespace todbench::testing
