// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/stop_signals.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>

namespace todbench {
namespace {

/// Wakes the waiting thread at the end; no other code sends it.
constexpr int own_signal = SIGUSR1;

sigset_t stopping_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, own_signal);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    const bool ignored = ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
    if (!ignored) sigaddset(&set, signal);
  }
  return set;
}

}  // namespace

StopSignals::StopSignals() {
  const sigset_t set = stopping_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  waiter_ = std::jthread([this, set] {
    while (true) {
      int signal = 0;
      sigwait(&set, &signal);
      if (leaving_) return;
      if (signal == own_signal) continue;
      // A second signal skips the orderly end of the session; files on disk stay readable.
      if (stop_.stop_requested() || !observed_) ::_exit(130);
      stop_.request_stop();
    }
  });
}

StopSignals::~StopSignals() {
  leaving_ = true;
  pthread_kill(waiter_.native_handle(), own_signal);
}

void StopSignals::wait() {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait(lock, token(), [] { return false; });
}

}  // namespace todbench
