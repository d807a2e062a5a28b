// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that a run keeps for each presentation: its answers and the record of the target, no pictures.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdio>
#include <map>
#include <string>

#include "bench/plan/plan.h"
#include "bench/run/experiment.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

/// Bytes in use on the heap, of all threads.
double bytes_in_use() {
  const auto heap = ::mallinfo2();
  return static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd);
}

TEST(RunMemory, GrowsByTheAnswersOfAPresentationAlone) {
  // 20 triangles: lists that double hold 4096 and 16384 answers then, 2 % more than there are.
  constexpr std::size_t few = 200, many = 800;
  constexpr double triangles = 20, name_of_triangle = 32;
  const testing::TemporaryFolder folder;
  std::map<std::size_t, double> in_use;
  ExperimentListener listener;
  listener.on_progress = [&](std::size_t done, std::size_t) {
    if (done == few || done == many) in_use[done] = bytes_in_use();
  };

  const auto plan = parse_plan(
      {.origin = "long",
       .text = "[target]\nkind = \"scene\"\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\n"
               "delta_t_k = [4]\n[fit]\nestimator = \"weibull\"\n[simulation]\nsensor = \"sc2000\"\n"
               "accuracy = \"draft\"\nphases = " +
               std::to_string(many) + "\n"},
      ".");
  ASSERT_TRUE(plan) << plan.error().message;

  const auto run = simulate_plan(*plan, {.folder = folder.path() / "run"}, listener, {});

  ASSERT_TRUE(run) << run.error().message;
  ASSERT_EQ(run->presentations.size(), many);
  ASSERT_EQ(in_use.size(), 2u);
  const double each = (in_use[many] - in_use[few]) / (many - few);
  std::printf("memory of a presentation: %.0f bytes; an answer has %zu, the record of a target %zu\n", each,
              sizeof(Trial), sizeof(Presentation));
  // A quarter more, for the lists and for what the heap adds to a block. A picture of 76800 counts would be 20 times as
  // much.
  EXPECT_LE(each, 1.25 * (triangles * (sizeof(Trial) + name_of_triangle) + sizeof(Presentation)));
}

}  // namespace
}  // namespace todbench
