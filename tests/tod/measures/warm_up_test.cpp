// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that warms up with a drift that is known.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/camera_measures/warm_up_measure.h"

namespace todbench {
namespace {

/// Level 300 K + A (1 - exp(-t / T)), a pattern that grows alike, white noise; offsets jump at a correction.
struct Warming {
  double level_k = 1, time_constant_s = 20, pattern_k = 0.1, noise_k = 0.05, frame_rate_hz = 10;
  std::optional<double> correction_s{};
  std::uint64_t seed = 1;

  [[nodiscard]] double grown(double t) const { return -std::expm1(-t / time_constant_s); }
};

class WarmingSource final : public FrameSource {
 public:
  explicit WarmingSource(Warming warming) : warming_(warming), pattern_(width * height) {
    scale_ =
        std::make_shared<RadiometricScale>(RadiometricScale::linear({.kelvin_per_count = 0.01, .offset_k = 0}).value());
    RandomStream(warming.seed, "test.pattern").fill_normal(pattern_);
    info_.width = width;
    info_.height = height;
  }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  void stop() override {}
  [[nodiscard]] Result<std::string> get(const std::string&) override { return fail(ErrorCode::invalid_input, ""); }
  [[nodiscard]] Result<void> set(const std::string&, const std::string&) override {
    return fail(ErrorCode::invalid_input, "");
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return fail(ErrorCode::invalid_input, ""); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    const double t = static_cast<double>(index_) / warming_.frame_rate_hz;
    const bool behind = warming_.correction_s && t >= *warming_.correction_s;
    const double grown = warming_.grown(t) - (behind ? warming_.grown(*warming_.correction_s) : 0);
    std::vector<float> noise(pattern_.size());
    RandomStream(warming_.seed, "test.noise").sub(index_).fill_normal(noise);
    Frame frame;
    frame.counts = cv::Mat1w(height, width);
    for (std::size_t i = 0; i < pattern_.size(); ++i) {
      const double kelvin =
          300 + warming_.level_k * grown + warming_.pattern_k * grown * pattern_[i] + warming_.noise_k * noise[i];
      frame.counts(static_cast<int>(i)) = static_cast<std::uint16_t>(std::lround(100 * kelvin));
    }
    frame.sequence = index_;
    frame.host_time_ns = static_cast<std::int64_t>(1e9 * t);
    frame.device_time_ns = frame.host_time_ns;
    if (warming_.correction_s) frame.since_correction_s = behind ? t - *warming_.correction_s : 100 + t;
    frame.scale = scale_;
    ++index_;
    return frame;
  }

 private:
  static constexpr int width = 48, height = 36;
  Warming warming_;
  SourceInfo info_;
  std::shared_ptr<const RadiometricScale> scale_;
  std::vector<float> pattern_;
  std::uint64_t index_ = 0;
};

Result<WarmUp> watched(const Warming& warming, double duration_s, double stable_k_per_min,
                       const ReadCameraTemperature& temperature = {}) {
  WarmingSource source(warming);
  FrameTakerOptions options;
  options.frames_after_change = 0;
  options.max_rejected_share = 0.5;
  FrameTaker taker(source, options);
  return measure_warm_up(taker,
                         {.duration_s = duration_s,
                          .start_s = 2,
                          .frame_rate_hz = warming.frame_rate_hz,
                          .stable_k_per_min = stable_k_per_min},
                         temperature, {});
}

TEST(WarmUp, HoldsTheDriftThatIsThere) {
  constexpr int seeds = 20;
  int constant_within = 0, level_within = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Warming warming{.seed = static_cast<std::uint64_t>(seed)};
    const auto found = watched(warming, 60, 0.5);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->law);
    const DriftFit& level = found->law->level;
    ASSERT_EQ(level.shape, DriftShape::approach);
    constant_within += *level.time_constant_ci95.low <= 20 && 20 <= *level.time_constant_ci95.high ? 1 : 0;
    // The pattern's mean over the pixels belongs to the level that these pixels have.
    const double change = warming.grown(found->law->time_s.back() - 2) - warming.grown(found->law->time_s.front() - 2);
    level_within += *level.change_ci95.low <= change && change <= *level.change_ci95.high ? 1 : 0;
    // A / T exp(-t / T) = 0.5 K/min at t = 20 s ln(60 / (20 * 0.5)), counted from the first image at 2 s.
    ASSERT_TRUE(found->stable_s);
    EXPECT_NEAR(*found->stable_s, 2 + 20 * std::log(6.0), 1.5);
  }
  // 20 seeds at 95 %: fewer than 15 come by chance once in 3000.
  EXPECT_GE(constant_within, 15);
  EXPECT_GE(level_within, 15);
}

TEST(WarmUp, GivesLevelPatternAndNoiseOfEveryGroup) {
  const Warming warming;

  const auto found = watched(warming, 60, 0.5);

  ASSERT_TRUE(found);
  EXPECT_EQ(found->groups.size(), 40u);
  for (const WarmUpGroup& group : found->groups) {
    const double grown = warming.grown(group.time_s - 2);
    // Standard error of the mean of 1728 pixels with this pattern: 0.1 K / sqrt(1728).
    EXPECT_NEAR(group.mean_k, 300 + grown, 4 * 0.1 / std::sqrt(1728.0) + 0.002);
    EXPECT_NEAR(group.pattern_k, 0.1 * grown, 0.01);
    EXPECT_NEAR(group.noise_k, 0.05, 0.005);
    EXPECT_FALSE(group.corrected);
  }
}

TEST(WarmUp, FitsNoLawOverACorrection) {
  const Warming warming{.correction_s = 15};

  const auto found = watched(warming, 60, 0.5);

  ASSERT_TRUE(found) << found.error().message;
  int corrected = 0;
  for (const WarmUpGroup& group : found->groups) corrected += group.corrected ? 1 : 0;
  EXPECT_EQ(corrected, 1);
  ASSERT_TRUE(found->law);
  EXPECT_GT(found->law->time_s.front(), 17);
  ASSERT_TRUE(found->law->level.time_constant_s);
  EXPECT_NEAR(*found->law->level.time_constant_s, 20, 3);
}

TEST(WarmUp, IsNotStableWhereTheBoundIsNotReached) {
  const auto found = watched({}, 60, 0.01);

  ASSERT_TRUE(found);
  EXPECT_FALSE(found->stable_s);
  EXPECT_FALSE(found->reasons.empty());
}

TEST(WarmUp, SetsTheLevelAgainstTheTemperatureOfTheCamera) {
  int reading = 0;
  // 0.1 K warmer with every group.
  const auto temperature = [&reading]() -> std::optional<double> { return 30 + 0.1 * reading++; };
  // The beginning of a slow approach is a line: 1e4 K / 1e5 s = 0.1 K/s.
  const Warming warming{.level_k = 1e4, .time_constant_s = 1e5, .pattern_k = 0};

  const auto found = watched(warming, 60, 10, temperature);

  ASSERT_TRUE(found && found->by_temperature);
  // 0.1 K/s times 1.5 s a group over 0.1 K a group.
  EXPECT_NEAR(found->by_temperature->slope, 1.5, 0.01);
  EXPECT_LT(found->by_temperature->slope_u, 0.01);
}

}  // namespace
}  // namespace todbench
