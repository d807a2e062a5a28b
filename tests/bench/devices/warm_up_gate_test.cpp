// SPDX-License-Identifier: GPL-3.0-or-later
// The gate before a run, on cameras that drift in a known way.
#include "bench/devices/warm_up_gate.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

/// 300 K + A (1 - exp(-t / T)) + rate t, at 10 frames a second.
class DriftingSource final : public FrameSource {
 public:
  DriftingSource(double amplitude_k, double time_constant_s, double k_per_min)
      : amplitude_k_(amplitude_k), time_constant_s_(time_constant_s), k_per_min_(k_per_min) {
    scale_ = std::make_shared<RadiometricScale>(RadiometricScale::linear({.kelvin_per_count = 0.01}).value());
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
    const double t = 0.1 * static_cast<double>(index_);
    const double level = 300 - amplitude_k_ * std::expm1(-t / time_constant_s_) + k_per_min_ * t / 60;
    std::vector<float> noise(width * height);
    RandomStream(1, "test.gate").sub(index_).fill_normal(noise);
    Frame frame;
    frame.counts = cv::Mat1w(height, width);
    for (std::size_t i = 0; i < noise.size(); ++i)
      frame.counts(static_cast<int>(i)) = static_cast<std::uint16_t>(std::lround(100 * (level + 0.05 * noise[i])));
    frame.sequence = index_++;
    frame.host_time_ns = frame.device_time_ns = static_cast<std::int64_t>(1e9 * t) + 1;
    frame.scale = scale_;
    return frame;
  }
  [[nodiscard]] double time_s() const { return 0.1 * static_cast<double>(index_ - 1); }

 private:
  static constexpr int width = 32, height = 24;
  double amplitude_k_, time_constant_s_, k_per_min_;
  SourceInfo info_;
  std::shared_ptr<const RadiometricScale> scale_;
  std::uint64_t index_ = 0;
};

FrameTakerOptions taking() {
  FrameTakerOptions options;
  options.frames_after_change = 0;
  return options;
}

TEST(WarmUpGate, WaitsForATime) {
  DriftingSource source(0, 1, 0);

  const auto done = wait_for_warm_up(source, {.time_s = 12}, taking(), {});

  ASSERT_TRUE(done) << done.error().message;
  EXPECT_NEAR(source.time_s(), 12, 0.11);
  EXPECT_THAT(*done, ::testing::HasSubstr("12.0 s"));
}

TEST(WarmUpGate, OpensWhenTheDriftIsBelowTheBound) {
  // The rate 60 A / T exp(-t / T) = 9 K/min exp(-t / 20 s) is 0.5 K/min at 57.8 s; the line through the window of 10 s
  // has the rate of its middle, and the interval of its noise (0.05 K over 768 pixels and 100 frames) is 0.008 K/min.
  DriftingSource source(3, 20, 0);

  const auto done = wait_for_warm_up(source, {.drift_k_per_min = 0.5, .window_s = 10, .timeout_s = 600}, taking(), {});

  ASSERT_TRUE(done) << done.error().message;
  EXPECT_NEAR(source.time_s(), 20 * std::log(18.0) + 5, 2);
}

TEST(WarmUpGate, EndsARunWhoseCameraNeverWarmsUp) {
  DriftingSource source(0, 1, 2);

  const auto done = wait_for_warm_up(source, {.drift_k_per_min = 0.5, .window_s = 5, .timeout_s = 30}, taking(), {});

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::calibration);
  EXPECT_THAT(done.error().message, ::testing::HasSubstr("did not end within 30 s"));
  EXPECT_NEAR(source.time_s(), 30, 0.2);
}

TEST(WarmUpGate, IsOpenWithoutConditions) {
  DriftingSource source(0, 1, 2);

  const auto done = wait_for_warm_up(source, {}, taking(), {});

  ASSERT_TRUE(done);
  EXPECT_EQ(*done, "");
}

TEST(DriftWindow, StartsAgainAfterACorrection) {
  DriftWindow window(10);
  for (int i = 0; i <= 100; ++i) window.add(0.1 * i, 300 + 0.01 * i);
  ASSERT_TRUE(window.k_per_min());
  EXPECT_NEAR(window.k_per_min()->value, 6, 1e-6);

  window.clear();
  window.add(10.1, 299);

  EXPECT_FALSE(window.k_per_min());
}

}  // namespace
}  // namespace todbench
