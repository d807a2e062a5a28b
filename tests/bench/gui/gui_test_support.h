// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of the window share: waiting on the thing, small plans, a window with the parts found by name.
#pragma once

#include <gmock/gmock.h>
#include <QPushButton>
#include <QtTest/QTest>
#include <array>
#include <functional>
#include <string>

#include "bench/gui/views/main_window.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {

/// Keys of the answers, by Apex.
inline constexpr std::array answer_keys{Qt::Key_Up, Qt::Key_Right, Qt::Key_Down, Qt::Key_Left};

/// Runs the event loop until something is so; false after a time in which it would have been on a loaded machine.
[[nodiscard]] bool wait_until(const std::function<bool()>& so, int patience_ms = 60'000);

/// Returns the faults of the shown page (page_check.h) on a small laptop, a desktop and a large screen, one a line,
/// with the size before each. Empty plots and pictures are no faults, nor is the message that a test provokes.
[[nodiscard]] std::string faults_at_three_sizes(MainWindow& window);

/// One plate, one mounting, two contrasts, few phases: 40 trials per phase.
[[nodiscard]] Plan small_plan(Plan plan, int phases);

/// A shown window with a folder for its sessions and a simulated camera or the emulated laboratory.
class ShownWindow {
 public:
  explicit ShownWindow(const QString& device, int phases = 3);
  MainWindow* operator->() { return &window_; }
  MainWindow& operator*() { return window_; }
  [[nodiscard]] const std::filesystem::path& sessions() const { return folder_.path(); }

  /// A part by its object name; fails the test when it is not there.
  template <typename T>
  [[nodiscard]] T& part(const char* name) {
    T* found = window_.findChild<T*>(name);
    if (found == nullptr) throw std::runtime_error(std::string("no part ") + name);
    return *found;
  }
  /// Clicks a button with the mouse; it has to be visible and enabled.
  void click(const char* button);
  /// Starts a measurement and waits for its end.
  void measure();

 private:
  TemporaryFolder folder_;
  MainWindow window_;
};

}  // namespace todbench::testing
