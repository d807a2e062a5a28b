// SPDX-License-Identifier: GPL-3.0-or-later
// The measurement on a bench with a hand only.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/tod/measurement/faulty_bench.h"
#include "tod/instruments/prompt_target.h"

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

/// A hand with the scene behind it: it sets the wrong sign where `slips` says so, by the requests so
/// far.
class SlippingHand final {
 public:
  SlippingHand(const SmallBench& bench, std::function<bool(const std::vector<OperatorRequest>&)> slips)
      : scene_(scene_target(bench.holder, bench.plates)), slips_(std::move(slips)) {
    target = prompt_target([this](const OperatorRequest& request, const std::stop_token& stop) {
      requests.push_back(request);
      for (const OperatorStep& step : request.steps) {
        if (const auto* put = std::get_if<PutInPlate>(&step)) shown_.plate = put->plate;
        if (const auto* set = std::get_if<SetContrast>(&step)) shown_.delta_t_k = set->delta_t_k;
      }
      TargetState shown = shown_;
      if (slips_(requests)) shown.delta_t_k *= -1;
      return scene_->present(shown, stop).map([](const PresentedTarget&) { return OperatorAnswer::done; });
    });
  }
  std::unique_ptr<Target> target;
  std::vector<OperatorRequest> requests;

 private:
  std::unique_ptr<Target> scene_;
  std::function<bool(const std::vector<OperatorRequest>&)> slips_;
  TargetState shown_;
};

TEST(MeasurementByHand, AsksAgainAfterASlipAndMeasuresAsWithoutIt) {
  SmallBench steady_bench, bench;
  SlippingHand steady(steady_bench, [](const auto&) { return false; });
  // With the first plate, and with the first change of the contrast alone.
  int changes = 0;
  SlippingHand slipping(bench, [&changes](const std::vector<OperatorRequest>& requests) {
    const auto& steps = requests.back().steps;
    return requests.size() == 1 ||
           (steps.size() == 1 && std::holds_alternative<SetContrast>(steps.front()) && ++changes == 1);
  });

  const auto expected = steady_bench.run(*steady_bench.camera(), *steady.target, test::options_of(steady_bench));
  const auto result = bench.run(*bench.camera(), *slipping.target, test::options_of(bench));

  ASSERT_TRUE(expected) << expected.error().message;
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_FALSE(result->ended_by);
  EXPECT_EQ(slipping.requests.size(), steady.requests.size() + 2);
  const auto* again = std::get_if<CheckAgain>(&slipping.requests.at(1).steps.front());
  ASSERT_NE(again, nullptr);
  EXPECT_THAT(again->reason, testing::HasSubstr("polarity"));
  EXPECT_THAT(slipping.requests.at(1).steps, testing::Contains(testing::VariantWith<PutInPlate>(testing::_)));
  EXPECT_THAT(slipping.requests.at(1).steps, testing::Contains(testing::VariantWith<SetContrast>(testing::_)));
  EXPECT_EQ(std::count_if(result->notes.begin(), result->notes.end(),
                          [](const std::string& n) { return n.find("requested again") != std::string::npos; }),
            2);
  // The camera's noise goes on, the presentations and their truth are the same ones.
  EXPECT_EQ(result->set_ups.size(), expected->set_ups.size());
  EXPECT_EQ(result->contrasts.size(), expected->contrasts.size());
  ASSERT_EQ(result->trials.size(), expected->trials.size());
  for (std::size_t i = 0; i < result->trials.size(); ++i) {
    EXPECT_EQ(result->trials[i].presentation, expected->trials[i].presentation);
    EXPECT_EQ(result->trials[i].truth, expected->trials[i].truth);
    EXPECT_GT(result->trials[i].delta_t_k * result->trials[i].set_delta_t_k, 0);
  }
}

TEST(MeasurementByHand, EndsIfTheSameRequestFailsAFourthTime) {
  SmallBench bench;
  SlippingHand hand(bench, [](const auto&) { return true; });

  const auto result = bench.run(*bench.camera(), *hand.target, test::options_of(bench));

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::calibration);
  EXPECT_EQ(hand.requests.size(), 4u);
}

}  // namespace
}  // namespace todbench
