// SPDX-License-Identifier: GPL-3.0-or-later
// A small plan and packages for what compares chains.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "bench/plan/plan.h"
#include "bench/plan/plan_options.h"

namespace todbench::testing_support {

/// One plate of a simulated SC2000 at these contrasts.
inline LoadedPlan small_plan(const std::string& contrasts, int phases, const std::string& more = "") {
  const std::string text =
      "name = \"small\"\n[target]\nkind = \"scene\"\ndistance_m = 2\nplates = [\"tcat-a\"]\n"
      "mountings = [\"identity\"]\ndelta_t_k = [" +
      contrasts + "]\n[simulation]\nsensor = \"sc2000\"\naccuracy = \"draft\"\nphases = " + std::to_string(phases) +
      "\n" + more;
  const auto plan = parse_plan({.origin = "small", .text = text}, ".");
  EXPECT_TRUE(plan) << plan.error().message;
  auto loaded = LoadedPlan::load(*plan);
  EXPECT_TRUE(loaded) << loaded.error().message;
  return *loaded;
}

inline EnhancementPackage package_of(std::vector<StagePlan> stages, const std::string& name = "package") {
  EnhancementPackage package;
  package.name = name;
  package.stages = std::move(stages);
  return package;
}

}  // namespace todbench::testing_support
