#include "acquisition/core/background.h"

#include <atomic>
#include <list>
#include <mutex>
#include <thread>

namespace todbench {
namespace {

/// The threads of start_in_background(). There is one list because there is one end of the program: a thread that runs
/// beyond it meets libraries that are gone.
class BackgroundThreads {
 public:
  BackgroundThreads() = default;
  BackgroundThreads(const BackgroundThreads&) = delete;
  BackgroundThreads& operator=(const BackgroundThreads&) = delete;
  /// Work may start more work, so until there is none.
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
    std::shared_ptr<std::atomic<bool>> ended;  ///< joining does not wait any more
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
