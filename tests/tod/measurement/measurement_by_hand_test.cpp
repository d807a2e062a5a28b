// SPDX-License-Identifier: GPL-3.0-or-later
// The measurement on a bench with a hand only.
#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "tests/tod/measurement/faulty_bench.h"

namespace todbench {
namespace {

using test::SmallBench;

/// A hand: goes near where it was asked to, never says where it is, and moves the plate by up to two pixels each time.
class HandTarget final : public Target {
 public:
  HandTarget(std::shared_ptr<SceneHolder> scene, std::vector<TargetPlate> plates)
      : target_(scene_target(std::move(scene), std::move(plates))) {
    capabilities_ = target_->capabilities();
    capabilities_.sets_shift = false;
  }
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    TargetState shown = state;
    shown.shift_mm = {5.2 * (random_.uniform(2 * count_) - 0.5), 5.2 * (random_.uniform(2 * count_ + 1) - 0.5)};
    ++count_;
    auto presented = target_->present(shown, stop);
    if (presented) presented->state = state;
    return presented;
  }

 private:
  std::unique_ptr<Target> target_;
  TargetCapabilities capabilities_;
  RandomStream random_{1, "hand"};
  std::uint64_t count_ = 0;
};

TEST(MeasurementByHand, FindsThePhaseOfEveryPresentationInThePicture) {
  SmallBench bench;
  bench.contrasts = {16.9, 0.23};
  bench.phases = 12;
  HandTarget hand(bench.holder, bench.plates);
  std::vector<cv::Point2d> shown;  // true phase of the first triangle at each presentation
  std::vector<cv::Point2d> found;
  const auto camera = bench.camera();
  MeasurementListener listener;
  listener.on_trial = [&](const Trial& trial) {
    if (trial.triangle != "row 1, triangle 1") return;
    const auto scene = bench.holder->scene();
    const cv::Point2d px =
        scene_pixel(*scene, scene->plate.triangles.front().position_mm, bench.spec.ifov_mrad(), {320, 240});
    shown.emplace_back(px.x - std::floor(px.x) - 0.5, px.y - std::floor(px.y) - 0.5);
    found.emplace_back(trial.phase_x_px, trial.phase_y_px);
  };

  const auto result = bench.run(*camera, hand, test::options_of(bench), listener);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_FALSE(result->ended_by.has_value()) << result->ended_by->message;
  ASSERT_EQ(shown.size(), 24u);
  double squares = 0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    // Phases wrap at half a pixel.
    const cv::Point2d d = shown[i] - found[i];
    squares += std::pow(d.x - std::round(d.x), 2) + std::pow(d.y - std::round(d.y), 2);
  }
  // 0.017 px per axis at 0.23 K with 16 frames (error of the shift measurement), with room for 24 presentations.
  EXPECT_LT(std::sqrt(squares / (2.0 * static_cast<double>(shown.size()))), 0.03);
}

}  // namespace
}  // namespace todbench
