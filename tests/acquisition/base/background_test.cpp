// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/background.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <thread>

namespace todbench {
namespace {

TEST(Background, RunsAndDestroysItsWorkOnAThreadOfItsOwn) {
  struct Leaving {
    std::promise<std::thread::id> destroyed;
    explicit Leaving(std::promise<std::thread::id> promise) : destroyed(std::move(promise)) {}
    ~Leaving() { destroyed.set_value(std::this_thread::get_id()); }
  };
  std::promise<std::thread::id> ran, destroyed;
  auto ran_on = ran.get_future(), destroyed_on = destroyed.get_future();

  finish_in_background([ran = std::move(ran), left = std::make_unique<Leaving>(std::move(destroyed))]() mutable {
    ran.set_value(std::this_thread::get_id());
  });

  const auto thread = ran_on.get();
  EXPECT_NE(thread, std::this_thread::get_id());
  EXPECT_EQ(destroyed_on.get(), thread);
}

std::atomic<bool> main_is_over = false;

/// Ends the program with work that goes on until after main, and with work that this begins.
[[noreturn]] void end_with_work_under_way() {
  finish_in_background([] {
    main_is_over.wait(false);
    finish_in_background([] { std::fputs("all done", stderr); });
  });
  std::atexit([] {
    main_is_over = true;
    main_is_over.notify_all();
  });
  std::exit(3);
}

TEST(Background, EndsBeforeTheProgramDoes) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");

  EXPECT_EXIT(end_with_work_under_way(), ::testing::ExitedWithCode(3), "all done");
}

}  // namespace
}  // namespace todbench
