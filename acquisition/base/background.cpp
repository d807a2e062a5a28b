// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/background.h"

#include <atomic>
#include <list>
#include <mutex>
#include <thread>

namespace todbench {
namespace {

/// The threads of start_in_background(), in one list for the whole program: a thread that runs past its end uses
/// libraries that are already unloaded.
class BackgroundThreads {
 public:
  BackgroundThreads() = default;
  BackgroundThreads(const BackgroundThreads&) = delete;
  BackgroundThreads& operator=(const BackgroundThreads&) = delete;
  /// Repeats until no thread is left, because work may start more work.
  ~BackgroundThreads() {
    for (std::list<Running> left = taken(); !left.empty(); left = taken()) {
      for (auto& one : left) one.thread.join();
    }
  }

  void start(std::function<void()> work) {
    auto ended = std::make_shared<std::atomic<bool>>(false);
    const std::lock_guard lock(mutex_);
    running_.remove_if([](Running& one) {
      if (!*one.ended) return false;
      one.thread.join();
      return true;
    });
    std::thread thread([work = std::move(work), ended]() mutable {
      work();
      work = nullptr;
      *ended = true;
    });
    running_.push_back({std::move(thread), std::move(ended)});
  }

 private:
  struct Running {
    std::thread thread;
    std::shared_ptr<std::atomic<bool>> ended;  ///< joining then returns at once
  };
  [[nodiscard]] std::list<Running> taken() {
    const std::lock_guard lock(mutex_);
    return std::exchange(running_, {});
  }

  std::mutex mutex_;
  std::list<Running> running_;
};

}  // namespace

void start_in_background(std::function<void()> work) {
  static BackgroundThreads threads;
  threads.start(std::move(work));
}

}  // namespace todbench
