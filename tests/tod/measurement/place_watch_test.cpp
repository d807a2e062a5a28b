// SPDX-License-Identifier: GPL-3.0-or-later
// Stages and pictures that are not where they were asked to be, through the measurement of a simulated camera.
#include "tod/measurement/place_watch.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "acquisition/base/rng.h"
#include "acquisition/core/forwarding_source.h"
#include "acquisition/core/judged_picture.h"
#include "tests/tod/measurement/measurement_bench.h"

namespace todbench {
namespace {

using test::options_of;
using test::SimulatedBench;
using ::testing::HasSubstr;

/// What is done to the scene of presentation k, of which the target says nothing.
using Fault = std::function<void(PlateScene&, int k)>;

class LyingTarget final : public Target {
 public:
  LyingTarget(std::unique_ptr<Target> target, std::shared_ptr<SceneHolder> holder, Fault fault)
      : target_(std::move(target)), holder_(std::move(holder)), fault_(std::move(fault)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    auto said = target_->present(state, std::move(stop));
    PlateScene scene = *holder_->scene();
    if (said && fault_) fault_(scene, shown_);
    ++shown_;
    holder_->set(std::move(scene));
    return said;
  }

 private:
  std::unique_ptr<Target> target_;
  std::shared_ptr<SceneHolder> holder_;
  Fault fault_;
  int shown_ = 0;
};

SimulatedBench bench_at(std::vector<double> contrasts, int phases = 12) {
  SimulatedBench bench;
  bench.contrasts = std::move(contrasts);
  bench.phases = phases;
  bench.mountings = {Mounting::identity, Mounting::rotated_180};
  return bench;
}

/// A camera behind which a stage adds noise.
class NoisyStageSource final : public ForwardingSource {
 public:
  NoisyStageSource(std::unique_ptr<FrameSource> camera, double counts)
      : ForwardingSource(std::move(camera)), counts_(counts) {}
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (!frame || counts_ == 0) return frame;
    cv::Mat1f noise(frame->counts.size());
    RandomStream(1, "stage").sub(frame->sequence).fill_normal({noise.ptr<float>(), noise.total()});
    JudgedPicture judged;
    cv::Mat1f(cv::Mat1f(frame->counts) + counts_ * noise).convertTo(judged.counts, CV_16U);
    frame->judged = std::make_shared<const JudgedPicture>(std::move(judged));
    return frame;
  }

 private:
  double counts_;
};

Result<MeasurementResult> run_with(const SimulatedBench& bench, const Fault& fault, double max_shift_error_px = 0.25,
                                   double stage_noise_counts = 0) {
  const auto model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, bench.skip, {}),
                                                         Accuracy::normal(), bench.seed);
  PlateScene scene;
  scene.plate = bench.plates.front();
  scene.distance_m = bench.distance_m;
  const auto holder = std::make_shared<SceneHolder>(scene);
  NoisyStageSource source(simulated_source(model, holder, "1"), stage_noise_counts);
  LyingTarget target(scene_target(holder, bench.plates), holder, fault);
  ListedSchedule schedule = schedule_of(bench);
  TemplateObserver observer({}, triangle_alternatives());
  MeasurementOptions options = options_of(bench);
  options.max_shift_error_px = max_shift_error_px;
  return measure(source, target, observer, schedule, options, *bench.host, {}, {});
}

/// Why a run ended, and after how many presentations.
std::string reason(const Result<MeasurementResult>& result) {
  if (!result) return result.error().message;
  return result->ended_by ? result->ended_by->message : "";
}

double mm_of_pixel(const SimulatedBench& bench) {
  return bench.distance_m * bench.spec.ifov_mrad();
}

TEST(PlaceWatch, RefusesAStageOfTheWrongSignWithinTheFirstPresentations) {
  const SimulatedBench bench = bench_at({16.9});
  const Fault mirrored = [](PlateScene& scene, int) { scene.shift_mm.x = -scene.shift_mm.x; };

  EXPECT_EQ(reason(run_with(bench, mirrored, 0)), "");
  const auto result = run_with(bench, mirrored);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_THAT(reason(result), HasSubstr("moves along x with the wrong sign"));
  EXPECT_EQ(result->ended_by->code, ErrorCode::calibration);
  EXPECT_LE(result->presentations.size(), 12u);
}

TEST(PlaceWatch, RefusesExchangedAxesAndAStageThatRestsOrIsWronglyScaled) {
  const SimulatedBench bench = bench_at({16.9});
  const auto ends = [&](const Fault& fault) { return reason(run_with(bench, fault)); };

  EXPECT_THAT(ends([](PlateScene& s, int) { std::swap(s.shift_mm.x, s.shift_mm.y); }), HasSubstr("exchanged"));
  EXPECT_THAT(ends([](PlateScene& s, int) { s.shift_mm = {0, 0}; }), HasSubstr("the stage does not move"));
  EXPECT_THAT(ends([](PlateScene& s, int) { s.shift_mm *= 0.4; }),
              HasSubstr("times the requested shift along x and by"));
}

TEST(PlaceWatch, SeesAStageThatRestsAtAContrastThatHidesThePlateInASinglePresentation) {
  const SimulatedBench bench = bench_at({0.23}, 24);

  EXPECT_THAT(reason(run_with(bench, [](PlateScene& s, int) { s.shift_mm = {0, 0}; })), HasSubstr("does not move"));
}

TEST(PlaceWatch, RefusesAPictureThatWasKnockedInMidRun) {
  const SimulatedBench bench = bench_at({16.9});
  const double pixel = mm_of_pixel(bench);

  const auto result = run_with(bench, [&](PlateScene& s, int k) { s.shift_mm.x += k < 7 ? 0 : 2 * pixel; });

  EXPECT_THAT(reason(result), HasSubstr("between presentations 6 and 7"));
}

// A contrast of 1 K is 14 standard deviations of the camera's noise, 3 of that behind the stage.
TEST(PlaceWatch, MissesAPlateByTheNoiseOfTheCameraAndNotByThatOfAStageBehindIt) {
  const SimulatedBench bench = bench_at({1}, 4);
  const double pixel = mm_of_pixel(bench);
  const Fault gone = [&](PlateScene& scene, int k) { scene.shift_mm.x += k < 2 ? 0 : 40 * pixel; };

  EXPECT_THAT(reason(run_with(bench, gone, 0.25, 30)), HasSubstr("were not found within 6 px"));
}

TEST(PlaceWatch, FollowsASlowDriftAndNotesIt) {
  const SimulatedBench bench = bench_at({16.9}, 24);
  const double pixel = mm_of_pixel(bench);
  // 0.3 px over the 96 presentations of the run, 0.075 px in each of its set-ups: too little to matter. Four times
  // that is followed.
  for (const double drift_px : {0.3, 0.8}) {
    const auto result = run_with(bench, [&](PlateScene& s, int k) { s.shift_mm.x += drift_px * pixel * k / 96; });

    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(reason(result), "");
    if (drift_px > 0.5) {
      EXPECT_THAT(result->notes, ::testing::Contains(HasSubstr("the picture was followed")));
    }
  }
}

TEST(PlaceWatch, NamesTheScaleOfAStageThatItFollows) {
  const SimulatedBench bench = bench_at({16.9}, 12);

  const auto result = run_with(bench, [](PlateScene& s, int) { s.shift_mm.y *= 0.85; });

  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(reason(result), "");
  EXPECT_THAT(result->notes, ::testing::Contains(HasSubstr("by 0.85 times along y, and the observed places were")));
}

TEST(PlaceWatch, RefusesAPlateThatTurnsBetweenPresentations) {
  const SimulatedBench bench = bench_at({16.9});

  const auto result = run_with(bench, [](PlateScene& s, int k) { s.rotation_deg += k < 7 ? 0 : 0.2; });

  EXPECT_THAT(reason(result), HasSubstr("turned by"));
}

TEST(PlaceWatch, KeepsTheBitsOfARunThatIsRight) {
  const SimulatedBench bench = bench_at({16.9, 1.93, 0.23}, 6);

  const auto looked = run_with(bench, {});
  const auto believed = run_with(bench, {}, 0);

  ASSERT_TRUE(looked && believed);
  ASSERT_EQ(reason(looked), "");
  ASSERT_EQ(looked->trials.size(), believed->trials.size());
  for (std::size_t i = 0; i < looked->trials.size(); ++i) {
    EXPECT_EQ(looked->trials[i].scores, believed->trials[i].scores);
    EXPECT_EQ(looked->trials[i].centroid, believed->trials[i].centroid);
  }
  // Every presentation of the two higher contrasts shows its place.
  double squares = 0;
  int seen = 0;
  for (const Presentation& shown : looked->presentations) {
    EXPECT_TRUE(shown.asked_px.has_value());
    if (!shown.seen_px) continue;
    squares += std::pow((shown.seen_px->x - shown.asked_px->x) / *shown.seen_error_px, 2);
    ++seen;
  }
  EXPECT_GE(seen, static_cast<int>(2 * looked->presentations.size() / 3));
  // The error is the larger one of both axes and of three estimates.
  EXPECT_LT(squares / seen, 1.5);
  EXPECT_GT(squares / seen, 0.3);
}

TEST(PlaceWatch, JudgesFramesByThePlaceThatWasSeen) {
  const SimulatedBench bench = bench_at({16.9});
  const double pixel = mm_of_pixel(bench);

  const auto moved = run_with(bench, [&](PlateScene& s, int k) { s.shift_mm.x += k < 3 ? 0 : 0.2 * pixel; });

  ASSERT_TRUE(moved.has_value());
  const Presentation& later = moved->presentations[8];
  ASSERT_TRUE(later.seen_px.has_value());
  EXPECT_NEAR(later.seen_px->x - later.asked_px->x, 0.2, 0.03);
  const auto right = run_with(bench, {});
  const auto centroid_of = [](const MeasurementResult& run) {
    for (const Trial& trial : run.trials) {
      if (trial.presentation == 8) return trial.centroid->x_px;
    }
    return 0.0;
  };
  EXPECT_NEAR(centroid_of(*moved) - centroid_of(*right), 0.2, 0.03);
}

}  // namespace
}  // namespace todbench
