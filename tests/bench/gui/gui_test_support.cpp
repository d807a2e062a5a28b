// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/gui/gui_test_support.h"

#include <QApplication>
#include <QElapsedTimer>

#include "bench/gui/views/page_check.h"
#include "tests/support/patience.h"

namespace todbench::testing {

bool wait_until(const std::function<bool()>& so, int patience_ms) {
  QElapsedTimer waited;
  waited.start();
  // One look decides: what is written again a moment later has been so all the same.
  while (!so()) {
    if (waited.elapsed() >= testing_support::patience(std::chrono::milliseconds(patience_ms)).count()) return false;
    // The loop sleeps until there is an event, at most as long as this timer.
    QEventLoop loop;
    QTimer::singleShot(10, &loop, &QEventLoop::quit);
    loop.exec();
  }
  return true;
}

namespace {

/// A label that gets its text during events waits for its layout, and a live picture gives it another text with every
/// frame. A fault of the window is still there after many turns.
std::vector<QString> lasting_faults_of(MainWindow& window) {
  std::vector<QString> faults;
  for (int turn = 0; turn < 20; ++turn) {
    QApplication::processEvents();
    for (int level = 0; level < 3; ++level) QApplication::sendPostedEvents(nullptr, QEvent::LayoutRequest);
    faults.clear();
    for (const QString& fault : faults_of(window)) {
      if (fault.startsWith("error: ") || fault.endsWith("empty plot") || fault.endsWith("empty picture")) continue;
      faults.push_back(fault);
    }
    if (faults.empty()) break;
  }
  return faults;
}

}  // namespace

std::string faults_at_three_sizes(MainWindow& window) {
  std::string found;
  const QSize before = window.size();
  for (const QSize size : {QSize(1024, 700), QSize(1366, 740), QSize(2560, 1400)}) {
    window.resize(size);
    QApplication::processEvents();
    const std::vector<QString> faults = lasting_faults_of(window);
    if (window.size() != size) found += std::to_string(size.width()) + ": the window does not become so small\n";
    for (const QString& fault : faults) found += std::to_string(size.width()) + ": " + fault.toStdString() + "\n";
  }
  window.resize(before);
  QApplication::processEvents();
  return found;
}

Plan small_plan(Plan plan, int phases) {
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9, 0.23};
  plan.target.phases = phases;
  plan.simulation.phases = phases;
  plan.measurement.registration_frames = 8;
  plan.measurement.contrast_frames = 4;
  plan.simulation.accuracy = "draft";
  plan.fit.estimator = EstimatorChoice::weibull;  // half the time of the run; what the window shows is the same
  return plan;
}

ShownWindow::ShownWindow(const QString& device, int phases) : window_(folder_.path(), Memory::forget) {
  // A test that closes or aborts does not wait for an answer in a box.
  window_.set_confirm([](const QString&, const QString&) { return true; });
  EXPECT_TRUE(window_.bench().select_device(device));
  window_.bench().set_plan(small_plan(window_.bench().plan(), phases));
  window_.resize(1366, 700);
  window_.show();
  EXPECT_TRUE(QTest::qWaitForWindowExposed(&window_));
}

void ShownWindow::click(const char* name) {
  auto& button = part<QPushButton>(name);
  ASSERT_TRUE(button.isVisible()) << name;
  ASSERT_TRUE(button.isEnabled()) << name;
  QTest::mouseClick(&button, Qt::LeftButton);
}

void ShownWindow::measure() {
  window_.show_view(View::measure);
  click("startMeasuring");
  ASSERT_TRUE(wait_until([&] { return window_.measure().state() == RunState::idle; }));
  ASSERT_TRUE(window_.measure().outcome()) << window_.measure().phase().toStdString();
}

}  // namespace todbench::testing
