// SPDX-License-Identifier: GPL-3.0-or-later
// Drift of the emulated GigE camera over several seeds: the figures of docs/validation/physical-measures.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "bench/plan/descriptions.h"
#include "sim_devices/lab/correction_drift.h"
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

/// A simulated camera whose frames drift from the first on as those of the emulated one after a correction, at the pace
/// at which they are asked for.
class DriftingFrames final : public FrameSource {
 public:
  DriftingFrames(FrameSource& camera, const SensorSpec& sensor, double level_k_per_min, double pattern_k_per_min,
                 std::uint64_t seed)
      : camera_(camera), sensor_(sensor), drift_(drift_pattern({camera.info().width, camera.info().height}, seed)) {
    drift_.draw = cv::Mat1d(level_k_per_min + pattern_k_per_min * drift_.draw);
  }
  const SourceInfo& info() const override { return camera_.info(); }
  Result<void> start() override { return camera_.start(); }
  Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = camera_.next(timeout);
    if (!frame) return frame;
    const double minutes = static_cast<double>(frame->sequence) / sensor_.frame_rate_hz / 60;
    frame->counts = with_pattern(frame->counts, drift_, minutes, frame->sequence, sensor_);
    return frame;
  }
  void stop() override { camera_.stop(); }
  Result<std::string> get(const std::string& feature) override { return camera_.get(feature); }
  Result<void> set(const std::string& feature, const std::string& value) override {
    return camera_.set(feature, value);
  }
  Result<void> correct_nonuniformity() override { return camera_.correct_nonuniformity(); }

 private:
  FrameSource& camera_;
  SensorSpec sensor_;
  DriftPattern drift_;
};

TEST(DriftingFramesStudy, HoldsTheDriftOfTheWholePictureInThePartThatThePlateCovers) {
  constexpr int seeds = 60;
  const SensorSpec sensor = *load_sensor("sc2000");
  const TargetPlate plate = *load_plate("tcat-a");
  for (const auto& [level_k, pattern_k] : {std::pair(0.6, 0.3), std::pair(0.6, 0.0), std::pair(0.0, 0.0)}) {
    int level = 0, pattern = 0;
    double squares = 0, half = 0;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const auto model =
          std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), seed);
      OpenedBench bench = simulated_bench(model, {plate}, 2, {});
      DriftingFrames camera(*bench.camera, sensor, level_k, pattern_k, seed);
      CameraMeasuresOptions options;
      options.drift_s = 4;
      options.transfer_steps_k = {16.9};
      options.measurement.ifov_mrad = sensor.ifov_mrad();
      options.measurement.distance_m = 2;
      options.measurement.plates = {plate};
      options.measurement.registration_frames = 4;
      options.measurement.free_running = false;
      const auto measures = measure_camera(camera, *bench.target, options, *bench.host, {});
      ASSERT_TRUE(measures && measures->drift);
      const DriftLaw& law = measures->drift->law;
      const auto holds = [&](const DriftFit& fit, double truth) {
        return law.per_minute(*fit.change_ci95.low) <= truth && truth <= law.per_minute(*fit.change_ci95.high);
      };
      level += holds(law.level, level_k) ? 1 : 0, pattern += holds(law.pattern, pattern_k) ? 1 : 0;
      squares += std::pow(law.per_minute(law.level.change_k) - level_k, 2) / seeds;
      half += 0.5 * law.per_minute(*law.level.change_ci95.high - *law.level.change_ci95.low) / seeds;
    }
    fmt::print("{} and {} K/min: level in {} of {}, error {:.5f}, half-width {:.5f}; pattern in {}\n", level_k,
               pattern_k, level, seeds, std::sqrt(squares), half, pattern);
    // Fewer than 51 of 60 come by chance once in 1300.
    EXPECT_GE(level, 51);
    EXPECT_GE(pattern, 51);
  }
}

TEST(GigeDriftStudy, HoldsTheProgrammedDrift) {
  constexpr int seeds = 40;
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
    // Fewer than 33 of 40 come by chance once in 1400.
    EXPECT_GE(level, 33);
    EXPECT_GE(pattern, 33);
  }
}

}  // namespace
}  // namespace todbench
