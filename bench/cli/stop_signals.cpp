#include "bench/cli/stop_signals.h"

#include <pthread.h>
#include <signal.h>

#include <condition_variable>
#include <mutex>

namespace todbench {
namespace {

sigset_t stopping_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

StopSignals::StopSignals() {
  const sigset_t set = stopping_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  waiter_ = std::jthread([this, set] {
    int signal = 0;
    sigwait(&set, &signal);
    stop_.request_stop();
  });
}

StopSignals::~StopSignals() {
  // The waiter is released by a signal of our own.
  pthread_kill(waiter_.native_handle(), SIGTERM);
}

void StopSignals::wait() {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait(lock, stop_.get_token(), [] { return false; });
}

}  // namespace todbench
