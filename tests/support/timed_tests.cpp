// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/timed_tests.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace todbench::testing_support {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto tick = 5ms, tolerated_delay = 10ms;
constexpr int most_attempts = 4;
constexpr const char* attempt_variable = "TODBENCH_TEST_ATTEMPT";

/// Knows by how much its ticks were late.
class LateTicks {
 public:
  LateTicks() : thread_([this](const std::stop_token& stop) { run(stop); }) {}
  /// The longest delay since the last call.
  Clock::duration take_longest() { return Clock::duration(longest_.exchange(0)); }

 private:
  void run(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      const auto due = Clock::now() + tick;
      never.wait_until(lock, stop, due, [] { return false; });
      const auto late = (Clock::now() - due).count();
      if (late > longest_) longest_ = late;
    }
  }

  std::atomic<Clock::rep> longest_ = 0;
  std::jthread thread_;
};

/// Remembers the cases that failed while the machine stood still, and whether others failed.
class FailedCases final : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo&) override { ticks_.take_longest(); }
  void OnTestEnd(const testing::TestInfo& test) override {
    if (!test.result()->Failed()) return;
    const auto late = ticks_.take_longest();
    if (late <= tolerated_delay) {
      others_failed = true;
      return;
    }
    std::printf("%s.%s: the machine stood still for %.0f ms, so this shows nothing\n", test.test_suite_name(),
                test.name(), std::chrono::duration<double, std::milli>(late).count());
    inconclusive.push_back(std::string(test.test_suite_name()) + '.' + test.name());
  }

  bool others_failed = false;
  std::vector<std::string> inconclusive;

 private:
  LateTicks ticks_;
};

/// The program anew with these cases only. Returns when it cannot be started.
void run_again(char** argv, const std::vector<std::string>& cases, int attempt) {
  std::string filter = "--gtest_filter=";
  for (const auto& name : cases) filter += name + ':';
  ::unsetenv("GTEST_TOTAL_SHARDS");
  ::unsetenv("GTEST_SHARD_INDEX");
  ::setenv(attempt_variable, std::to_string(attempt).c_str(), 1);
  std::fflush(nullptr);
  char* arguments[] = {argv[0], filter.data(), nullptr};
  ::execv("/proc/self/exe", arguments);
}

}  // namespace

int run_timed_tests(char** argv) {
  const char* attempt_text = std::getenv(attempt_variable);
  const int attempt = attempt_text == nullptr ? 1 : std::atoi(attempt_text);
  auto* failed = new FailedCases;
  testing::UnitTest::GetInstance()->listeners().Append(failed);  // which owns it
  const int status = RUN_ALL_TESTS();
  if (!failed->inconclusive.empty() && !failed->others_failed && attempt < most_attempts)
    run_again(argv, failed->inconclusive, attempt + 1);
  return status;
}

}  // namespace todbench::testing_support
