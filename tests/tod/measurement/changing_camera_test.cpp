// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that changes half-way through a run without losing a frame.
#include <gmock/gmock.h>

#include <deque>
#include <functional>

#include "acquisition/base/rng.h"
#include "tests/tod/measurement/grey_frames.h"
#include "tests/tod/measurement/measurement_bench.h"
#include "tod/measurement/run_constancy.h"

namespace todbench {
namespace {

/// Counts of an exposure on their way to the client.
using Change = std::function<cv::Mat1w(const cv::Mat1w& counts, std::uint64_t exposure)>;

/// Four set-ups of 70 exposures each: 32 and 16 for each contrast are averaged, two are judged, four discarded.
constexpr std::uint64_t half_way = 140;

class ChangingSource final : public FrameSource {
 public:
  ChangingSource(std::unique_ptr<FrameSource> camera, Change change, ContrastUnit unit)
      : camera_(std::move(camera)), change_(std::move(change)), unit_(unit), info_(camera_->info()) {
    if (unit_ == ContrastUnit::grey_levels) info_.scale = {};
  }

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }
  void stop() override { camera_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& f) override { return camera_->get(f); }
  [[nodiscard]] Result<void> set(const std::string& f, const std::string& v) override { return camera_->set(f, v); }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return camera_->correct_nonuniformity(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = camera_->next(timeout);
    if (!frame) return frame;
    if (change_) frame->counts = change_(frame->counts, exposure_);
    if (unit_ == ContrastUnit::grey_levels) put_grey_levels(*frame);
    ++exposure_;
    return frame;
  }

 private:
  /// Eight bits of a gain control: about ten levels a kelvin, another gain in every frame, and a fifth less in the
  /// second half of the run.
  void put_grey_levels(Frame& frame) const {
    const double restless = 1 + 0.1 * RandomStream(5, "gain").uniform(exposure_);
    const double gain = (exposure_ < half_way ? 0.1 : 0.08) * restless;
    frame.counts = test::grey(frame.counts, gain, 5000);
    frame.significant_bits = 8;
    frame.scale = std::make_shared<const RadiometricScale>();
  }

  std::unique_ptr<FrameSource> camera_;
  Change change_;
  ContrastUnit unit_;
  SourceInfo info_;
  std::uint64_t exposure_ = 0;
};

Result<MeasurementResult> run_of(std::uint64_t seed, Change change, ContrastUnit unit = ContrastUnit::kelvin) {
  test::SimulatedBench bench;
  bench.mountings = {Mounting::identity, Mounting::rotated_180};
  bench.contrasts = {16.9, 1.93};
  bench.phases = 1;
  bench.seed = seed;
  if (unit == ContrastUnit::grey_levels)
    bench.spec.netd_k = 0.2;  // behind the filter successive frames differ by 0.65 levels
  const auto model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, bench.skip, {}),
                                                         Accuracy::normal(), bench.seed);
  PlateScene scene;
  scene.plate = bench.plates.front();
  scene.distance_m = bench.distance_m;
  const auto holder = std::make_shared<SceneHolder>(scene);
  ChangingSource source(simulated_source(model, holder, "1"), std::move(change), unit);
  const auto target = scene_target(holder, bench.plates);
  ListedSchedule schedule = test::schedule_of(bench);
  MeasurementOptions options = test::options_of(bench);
  options.frames_after_change = 2;
  options.contrast_unit = unit;
  if (unit == ContrastUnit::kelvin) options.max_shift_error_px = 0.25;
  TemplateObserver observer({}, triangle_alternatives());
  return measure(source, *target, observer, schedule, options, *bench.host, {}, {});
}

cv::Mat1w in_counts(const cv::Mat1d& counts) {
  cv::Mat1w out;
  counts.convertTo(out, CV_16U);
  return out;
}

struct Found {
  bool transfer = false, noise = false, correlation = false, residue = false, presented = false;
  bool operator==(const Found&) const = default;
};

Found found_in(const MeasurementResult& run) {
  const auto beyond = [](const auto& figure) { return figure && figure->beyond(); };
  const auto& residue = run.constancy.residue;
  return {beyond(transfer_change(run.contrasts)), beyond(noise_change(run.constancy.noise)),
          beyond(correlation_change(run.constancy.noise)), residue && residue->share > residue->limit,
          beyond(presented_change(run.constancy.presented))};
}

TEST(ChangingCamera, ThatDoesNotChangeHasNoFinding) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto run = run_of(seed, {});
    ASSERT_TRUE(run) << run.error().message;
    EXPECT_EQ(run->constancy.noise.size(), 8U);
    EXPECT_TRUE(run->constancy.residue);
    EXPECT_EQ(found_in(*run), Found{}) << seed;
  }
}

TEST(ChangingCamera, OfAnotherGainIsFound) {
  double middle = 0;
  const auto run = run_of(1, [&](const cv::Mat1w& counts, std::uint64_t exposure) {
    if (middle == 0) middle = cv::mean(counts)[0];
    if (exposure < half_way) return counts;
    cv::Mat1d other;
    counts.convertTo(other, CV_64F);
    return in_counts((other - middle) * 1.1 + middle);
  });
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_TRUE(found_in(*run).transfer);
  EXPECT_NEAR(transfer_change(run->contrasts)->value, 0.1, 0.02);
}

TEST(ChangingCamera, OfAnotherGainInThePresentationsAloneIsFound) {
  double middle = 0;
  const auto run = run_of(1, [&](const cv::Mat1w& counts, std::uint64_t exposure) {
    if (middle == 0) middle = cv::mean(counts)[0];
    // The judged frames of a set-up.
    if (exposure % 70 != 50 && exposure % 70 != 69) return counts;
    cv::Mat1d other;
    counts.convertTo(other, CV_64F);
    return in_counts((other - middle) * 1.2 + middle);
  });
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->constancy.presented.size(), 8U);
  EXPECT_EQ(found_in(*run), Found{.presented = true});
  EXPECT_NEAR(presented_change(run->constancy.presented)->value, 0.2, 0.03);
}

Change more_noise() {
  return [draw = std::uint64_t{0}](const cv::Mat1w& counts, std::uint64_t exposure) mutable {
    if (exposure < half_way) return counts;
    const RandomStream stream(1, "more noise");
    cv::Mat1d other;
    counts.convertTo(other, CV_64F);
    for (double& pixel : other) pixel += 60 * stream.normal(draw++);
    return in_counts(other);
  };
}

Change filter_over_frames() {
  return [state = cv::Mat1d()](const cv::Mat1w& counts, std::uint64_t exposure) mutable {
    cv::Mat1d other;
    counts.convertTo(other, CV_64F);
    state = exposure < half_way ? other : cv::Mat1d(0.5 * state + 0.5 * other);
    return in_counts(state);
  };
}

TEST(ChangingCamera, WithMoreNoiseIsFound) {
  const auto run = run_of(1, more_noise());
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_TRUE(found_in(*run).noise);
}

TEST(ChangingCamera, WithAFilterOverFramesIsFound) {
  const auto run = run_of(1, filter_over_frames());
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_TRUE(found_in(*run).noise);
  EXPECT_TRUE(found_in(*run).correlation);
}

TEST(ChangingCamera, InGreyLevelsWhoseGainAloneChangesHasNoFinding) {
  for (const std::uint64_t seed : {1, 2}) {
    const auto run = run_of(seed, {}, ContrastUnit::grey_levels);
    ASSERT_TRUE(run) << run.error().message;
    ASSERT_EQ(run->constancy.noise.size(), 8U);
    // The response of the large triangles is not known here, which leaves 5 %.
    for (const PictureNoise& one : run->constancy.noise) EXPECT_NEAR(one.noise_k / 0.2, 1, 0.1) << one.set_delta_t_k;
    EXPECT_EQ(found_in(*run), Found{}) << seed;
  }
}

TEST(ChangingCamera, InGreyLevelsWithMoreNoiseIsFound) {
  const auto run = run_of(1, more_noise(), ContrastUnit::grey_levels);
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_TRUE(found_in(*run).noise);
  EXPECT_FALSE(found_in(*run).correlation);
}

TEST(ChangingCamera, InGreyLevelsWithAFilterOverFramesIsFound) {
  const auto run = run_of(1, filter_over_frames(), ContrastUnit::grey_levels);
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_TRUE(found_in(*run).correlation);
}

TEST(ChangingCamera, WhosePicturesComeLateIsFound) {
  std::deque<cv::Mat1w> on_the_way;
  const auto run = run_of(1, [&](const cv::Mat1w& counts, std::uint64_t) {
    constexpr std::size_t late = 5;
    on_the_way.push_back(counts.clone());
    if (on_the_way.size() <= late) return counts;
    cv::Mat1w old = on_the_way.front();
    on_the_way.pop_front();
    return old;
  });
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_TRUE(found_in(*run).residue);
}

}  // namespace
}  // namespace todbench
