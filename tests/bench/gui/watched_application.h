// SPDX-License-Identifier: GPL-3.0-or-later
// An application that knows how long its thread was kept by one event.
#pragma once

#include <QApplication>
#include <cstdint>

namespace todbench::testing {

class WatchedApplication final : public QApplication {
 public:
  WatchedApplication(int& argc, char** argv) : QApplication(argc, argv) {}
  bool notify(QObject* receiver, QEvent* event) override;

  /// Forgets what was before.
  static void reset();
  /// The longest time since reset() that one event kept the thread: running or blocked, without the time in which the
  /// thread was ready and the system let others run (/proc/thread-self/schedstat).
  [[nodiscard]] static double longest_ms();
  /// Receiver and type of that event, for messages.
  [[nodiscard]] static QString longest_event();
};

}  // namespace todbench::testing
