// SPDX-License-Identifier: GPL-3.0-or-later
// Packages of a gain: how far they move answers and acuities.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "tests/bench/enhance/enhancement_support.h"

namespace todbench::testing_support {

inline StagePlan kernel_of(const std::array<double, 9>& kernel) {
  return {.kind = StagePlan::Kind::kernel, .kernel = kernel};
}

/// x -> gain x.
inline EnhancementPackage gain_of(double gain) {
  return package_of({kernel_of({0, 0, 0, 0, gain, 0, 0, 0, 0})}, "gain");
}

/// A small plan at 4 K with a shipped observer, and a sensor of 16 bits whose counts are this large.
inline LoadedPlan plan_of_counts(const std::string& observer, int phases, std::uint64_t seed, double kelvin_per_count) {
  const LoadedPlan loaded = small_plan("4", phases, "[observer]\nname = \"" + observer + "\"\n");
  PlanParts parts = loaded.parts();
  parts.sensor.bits = 16;
  parts.sensor.kelvin_per_count = kelvin_per_count;
  parts.sensor.offset_k = parts.sensor.scene_temperature_k - 10;
  Plan plan = loaded.plan();
  plan.seed = seed;
  return LoadedPlan::of(plan, parts).value();
}

/// How far a package moves the answers, and the acuity at the first contrast.
struct Moved {
  double answers = 0;  ///< share of the trials that are answered otherwise
  double ln_ratio = 0;
  std::optional<double> half_width{};  ///< of the 95 % interval of ln ratio
};

inline Moved moved_by(const PackageResult& with, const PackageResult& without) {
  Moved out;
  EXPECT_EQ(with.trials.size(), without.trials.size());
  for (std::size_t i = 0; i < std::min(with.trials.size(), without.trials.size()); ++i)
    out.answers += with.trials[i].answer != without.trials[i].answer ? 1 : 0;
  out.answers /= static_cast<double>(std::max<std::size_t>(1, with.trials.size()));
  const PairedRatio& ratio = with.ratios.at(0);
  EXPECT_TRUE(ratio.ratio) << ratio.withheld;
  if (ratio.ratio) out.ln_ratio = std::log(*ratio.ratio);
  if (ratio.ci95.low && ratio.ci95.high) out.half_width = std::log(*ratio.ci95.high / *ratio.ci95.low) / 2;
  return out;
}

}  // namespace todbench::testing_support
