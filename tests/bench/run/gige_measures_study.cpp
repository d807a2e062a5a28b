// Drift of the emulated GigE camera over several seeds: the figures of docs/physical-measures.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bench/plan/descriptions.h"
#include "tests/bench/run/emulated_measures.h"

namespace todbench {
namespace {

Result<DriftLaw> drift_of_seed(double level_k_per_min, double pattern_k_per_min, std::uint64_t seed) {
  Plan plan = *load_plan("demo");
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.simulation.accuracy = "draft";
  plan.measurement.registration_frames = 4;
  plan.measurement.frame_timeout_ms = 20000;
  plan.camera.nuc_interval_s = 100, plan.camera.nuc_wait_s = 0.2;
  EmulationArguments arguments = emulation_for(plan);
  arguments.seed = seed;
  arguments.drift_k_per_min = level_k_per_min, arguments.drift_pattern_k_per_min = pattern_k_per_min;
  CameraMeasuresOptions options;
  options.drift_s = 4;
  const auto measures = testing::measured(plan, arguments, options);
  if (!measures) return tl::unexpected(measures.error());
  if (!measures->drift) return fail(ErrorCode::internal, measures->reasons.empty() ? "" : measures->reasons.front());
  return measures->drift->law;
}

TEST(GigeDriftStudy, HoldsTheProgrammedDrift) {
  constexpr int seeds = 20;
  for (const double factor : {0.0, 1.0}) {
    int level = 0, pattern = 0;
    double mean = 0, half = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const double level_k = 0.6 * factor, pattern_k = 0.3 * factor;
      const auto law = drift_of_seed(level_k, pattern_k, static_cast<std::uint64_t>(seed));
      ASSERT_TRUE(law) << law.error().message;
      const auto holds = [&](const DriftFit& fit, double truth) {
        const double low = law->per_minute(fit.change_ci95.low.value_or(-1e9));
        const double high = law->per_minute(fit.change_ci95.high.value_or(1e9));
        return low <= truth && truth <= high;
      };
      level += holds(law->level, level_k) ? 1 : 0, pattern += holds(law->pattern, pattern_k) ? 1 : 0;
      mean += (law->per_minute(law->level.change_k) - level_k) / seeds;
      half += 0.5 * law->per_minute(law->level.change_ci95.high.value() - law->level.change_ci95.low.value()) / seeds;
      fmt::print("seed {} level {:+.5f} [{:+.5f} {:+.5f}] pattern {:.5f} [{:.5f} {:.5f}] K/min, {}\n", seed,
                 law->per_minute(law->level.change_k), law->per_minute(law->level.change_ci95.low.value()),
                 law->per_minute(law->level.change_ci95.high.value()), law->per_minute(law->pattern.change_k),
                 law->per_minute(law->pattern.change_ci95.low.value()),
                 law->per_minute(law->pattern.change_ci95.high.value()), to_string(law->level.shape));
    }
    fmt::print("{} K/min: level holds in {} of {}, mean error {:+.5f}, half width {:.5f}; pattern in {}\n",
               0.6 * factor, level, seeds, mean, half, pattern);
    // Fewer than 15 of 20 come by chance once in 3000.
    EXPECT_GE(level, 15);
    EXPECT_GE(pattern, 15);
  }
}

}  // namespace
}  // namespace todbench
