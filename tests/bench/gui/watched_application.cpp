// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/gui/watched_application.h"

#include <QThread>
#include <chrono>
#include <cstdio>

namespace todbench::testing {
namespace {

// Of the one application of a test program; touched by its thread only.
double longest = 0;
QString longest_name;
int depth = 0;

double ready_ms() {
  std::FILE* file = std::fopen("/proc/thread-self/schedstat", "re");
  if (file == nullptr) return 0;
  unsigned long long running = 0, ready = 0;
  const int read = std::fscanf(file, "%llu %llu", &running, &ready);
  std::fclose(file);
  return read == 2 ? static_cast<double>(ready) * 1e-6 : 0;
}

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

bool WatchedApplication::notify(QObject* receiver, QEvent* event) {
  // An event loop inside an event, as of a test that waits, is not an event that takes long.
  if (depth > 0 || QThread::currentThread() != thread()) return QApplication::notify(receiver, event);
  ++depth;
  const QString name = QString(receiver->metaObject()->className()) + " " + receiver->objectName() + ", event " +
                       QString::number(event->type());
  const double began = now_ms(), ready = ready_ms();
  const bool done = QApplication::notify(receiver, event);
  const double taken = now_ms() - began - (ready_ms() - ready);
  --depth;
  if (taken > longest) {
    longest = taken;
    longest_name = name;
  }
  return done;
}

void WatchedApplication::reset() {
  longest = 0;
  longest_name.clear();
}

double WatchedApplication::longest_ms() {
  return longest;
}

QString WatchedApplication::longest_event() {
  return longest_name;
}

}  // namespace todbench::testing
