// SPDX-License-Identifier: GPL-3.0-or-later
// A stage that scans a pixel: the frames prove the scan, and the finer picture is judged.
#include "bench/enhance/stage_scan.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "acquisition/base/host_clock.h"
#include "bench/enhance/blind_judgement.h"
#include "bench/enhance/enhancement.h"
#include "sim_devices/sensor/super_resolution_stage.h"
#include "tests/bench/run/measured_session.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::MeasuredSession;

/// Moves a share of every requested shift.
class LazyStage final : public Target {
 public:
  LazyStage(std::unique_ptr<Target> target, double share) : target_(std::move(target)), share_(share) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    TargetState moved = state;
    moved.shift_mm *= share_;
    auto said = target_->present(moved, std::move(stop));
    if (said) said->state.shift_mm = state.shift_mm;
    return said;
  }

 private:
  std::unique_ptr<Target> target_;
  double share_;
};

class StageScanTest : public MeasuredSession {
 protected:
  /// Measures with the emulated instruments, whose stage scans 2 x 2 places and moves this share of its way.
  Result<ExperimentOutcome> measure_scanned(const std::string& name, double share) {
    plan_.target.delta_t_k = {16.9};
    plan_.target.phases = 6;
    plan_.target.max_shift_error_px = 0;
    plan_.schedule.answers = AnswersChoice::binary;
    plan_.schedule.frames_per_presentation = {0};
    plan_.measurement.registration_frames = 8;
    plan_.measurement.frames_after_change = 3;
    const auto loaded = LoadedPlan::load(plan_).value();
    EffectPlanner planner;
    const auto inputs = experiment_inputs(loaded, planner).value();
    OpenedBench bench = MeasuredSession::bench(inputs);
    bench.target = std::make_unique<LazyStage>(std::move(bench.target), share);
    const double pixel_mm = plan_.target.distance_m * plan_.camera.ifov_mrad;
    if (auto scanned = scan_with_stage(bench, {.steps = 2, .pixel_mm = pixel_mm, .frames_after_move = 0}); !scanned)
      return tl::unexpected(scanned.error());
    return measure_on_bench(loaded, inputs, std::move(bench), options(name), {}, {});
  }
  /// Judges the session without a package and by super-resolution of the scan.
  [[nodiscard]] Result<Enhancement> finer(const std::string& name) const {
    const auto loaded = recorded_plan(at(name), {});
    if (!loaded) return tl::unexpected(loaded.error());
    return compare_packages_recorded(at(name), *loaded, {super_resolution()}, {.dither = 2}, {});
  }
  [[nodiscard]] static EnhancementPackage super_resolution() {
    EnhancementPackage package;
    package.name = "DSR2";
    package.stages = {{.kind = StagePlan::Kind::super_resolution,
                       .super_resolution = {.frames = 4, .factor = 2, .shifts = FrameShifts::scan}}};
    return package;
  }
};

/// The answer of a person with this S75: Weibull of slope 3 with a chance of a quarter.
Apex answer_of_person(const Trial& trial, double s75_mrad, const RandomStream& person, std::uint64_t number) {
  const double right = 1 - 0.75 * std::exp(-std::log(3.0) * std::pow(trial.size_mrad / s75_mrad, 3));
  const auto turns = person.uniform(2 * number) < right ? 0 : 1 + person.below(2 * number + 1, 3);
  return all_apexes[(static_cast<std::size_t>(trial.truth) + turns) % 4];
}

TEST_F(StageScanTest, OfTheInstrumentsIsProvenByTheFramesAndTheFinerPictureResolvesMore) {
  const auto run = measure_scanned("m", 1);
  ASSERT_TRUE(run) << run.error().message;
  ASSERT_FALSE(run->ended_by) << run->ended_by->message;

  const auto found = finer("m");

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->dither, 2);
  const PackageResult &still = found->results[0], &dsr2 = found->results[1];
  ASSERT_FALSE(dsr2.error) << dsr2.error->message;
  EXPECT_EQ(dsr2.samples_per_pixel, 2);
  ASSERT_EQ(dsr2.trials.size(), still.trials.size());
  for (const PackageResult* result : {&still, &dsr2}) {
    ASSERT_EQ(result->curve.points.size(), 1U);
    EXPECT_FALSE(result->curve.points.front().lag1_correlation) << "frames differ by their places";
  }
  const auto right = [](const std::vector<Trial>& trials) {
    return std::ranges::count_if(trials, [](const Trial& trial) { return trial.correct(); });
  };
  EXPECT_GT(right(dsr2.trials), right(still.trials));
}

TEST_F(StageScanTest, IsJudgedBlindByPeopleBesideTheFramesOfTheCamera) {
  const auto run = measure_scanned("m", 1);
  ASSERT_TRUE(run) << run.error().message;

  const auto sources = blind_sources(at("m"), {super_resolution()}, false, at("blind"), {}, {});

  ASSERT_TRUE(sources) << sources.error().message;
  ASSERT_EQ(sources->size(), 2U);
  EXPECT_EQ((*sources)[1].samples_per_pixel, 2);
  const auto right = [](const BlindSource& source) {
    return std::ranges::count_if(source.trials, [](const JudgedTrial& judged) { return judged.trial.correct(); });
  };
  ASSERT_EQ((*sources)[0].trials.size(), (*sources)[1].trials.size());
  EXPECT_GT(right((*sources)[1]), right((*sources)[0])) << "the model observer sees the finer picture";
  // Seeds 1 to 40: people who see 1.3 times finer through the package.
  const double s75_mrad[] = {2.6, 2.0};
  int hold = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto patches = blind_order(*sources, 6, seed);
    ASSERT_TRUE(patches) << patches.error().message;
    const RandomStream person(seed, "person");
    std::vector<BlindAnswer> answers;
    for (const BlindPatch& patch : *patches) {
      EXPECT_EQ(patch.judged.patch_k.rows % patch.samples_per_pixel, 0);
      BlindAnswer answer{.source = patch.source, .trial = patch.judged.trial};
      answer.trial.answer = answer_of_person(answer.trial, s75_mrad[patch.source], person, answers.size());
      answers.push_back(std::move(answer));
    }
    const auto result = blind_result({"camera", "DSR2"}, answers, plan_);
    ASSERT_TRUE(result) << result.error().message;
    const auto& ratio = result->ratios.front().points.front().ratio_ci95;
    if (ratio.low.value_or(0) <= 1.3 && 1.3 <= ratio.high.value_or(1e9)) ++hold;
  }
  // 95 % of 40 with a binomial standard deviation of 1.4; four of them below.
  EXPECT_GE(hold, 38 - 4 * 1.4);
}

TEST_F(StageScanTest, OfASecondStageHasToBeThatOfTheCameraToo) {
  EnhancementPackage twice = super_resolution();
  twice.stages.push_back(twice.stages.front());
  EXPECT_TRUE(check_scans({twice}, 2));

  twice.stages.back().super_resolution.factor = 3;

  const auto checked = check_scans({twice}, 2);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, HasSubstr("--dither 3"));
}

TEST_F(StageScanTest, OfHalfTheStepIsRefusedByItsFrames) {
  const auto run = measure_scanned("m", 0.5);
  ASSERT_TRUE(run) << run.error().message;

  const auto found = finer("m");

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->results[1].error);
  EXPECT_EQ(found->results[1].error->code, ErrorCode::calibration);
  EXPECT_THAT(found->results[1].error->message, HasSubstr("do not follow the scan"));
}

/// Frames numbered by a list, exposed before or after the last move.
class NumberedCamera final : public FrameSource {
 public:
  explicit NumberedCamera(std::deque<std::uint64_t> numbers) : numbers_(std::move(numbers)) {}
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (numbers_.empty()) return fail(ErrorCode::timeout, "no frame");
    Frame frame;
    frame.sequence = numbers_.front();
    frame.host_time_ns = monotonic_ns();
    numbers_.pop_front();
    return frame;
  }
  void stop() override {}
  [[nodiscard]] Result<std::string> get(const std::string&) override { return fail(ErrorCode::invalid_input, ""); }
  [[nodiscard]] Result<void> set(const std::string&, const std::string&) override { return {}; }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return {}; }

 private:
  std::deque<std::uint64_t> numbers_;
  SourceInfo info_;
};

struct MovesOfStage {
  std::vector<cv::Point2d> shifts_mm;
  bool fails = false;
};
class RememberingStage final : public Target {
 public:
  RememberingStage(std::shared_ptr<MovesOfStage> moves, bool sets_shift) : moves_(std::move(moves)) {
    capabilities_.sets_shift = sets_shift;
  }
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token) override {
    if (moves_->fails) return fail(ErrorCode::timeout, "the stage does not arrive");
    moves_->shifts_mm.push_back(state.shift_mm);
    PresentedTarget said;
    said.state = state;
    return said;
  }

 private:
  std::shared_ptr<MovesOfStage> moves_;
  TargetCapabilities capabilities_;
};

OpenedBench remembering_bench(const std::shared_ptr<MovesOfStage>& moves, std::deque<std::uint64_t> numbers,
                              bool sets_shift = true) {
  OpenedBench bench;
  bench.camera = std::make_unique<NumberedCamera>(std::move(numbers));
  bench.target = std::make_unique<RememberingStage>(moves, sets_shift);
  return bench;
}

TEST(StageScan, MovesFromThePlaceOfThePresentationAndHidesOnlyItsOwnDrops) {
  const auto moves = std::make_shared<MovesOfStage>();
  // One frame is dropped after each move; the camera itself loses number 16.
  OpenedBench bench = remembering_bench(moves, {10, 11, 12, 13, 14, 15, 17, 18, 19});
  ASSERT_TRUE(scan_with_stage(bench, {.steps = 2, .pixel_mm = 0.8, .frames_after_move = 1}));
  TargetState state;
  state.shift_mm = {1, 2};

  std::vector<std::uint64_t> numbers{bench.camera->next({}).value().sequence};  // no state yet: no move
  ASSERT_TRUE(bench.target->present(state, {}));
  for (int k = 0; k < 4; ++k) numbers.push_back(bench.camera->next({}).value().sequence);

  // Presented, then places 1, 2, 3 and 0 of the scan: one frame came before.
  EXPECT_THAT(moves->shifts_mm, ::testing::ElementsAre(cv::Point2d(1, 2), cv::Point2d(1.4, 2), cv::Point2d(1, 2.4),
                                                       cv::Point2d(1.4, 2.4), cv::Point2d(1, 2)));
  EXPECT_THAT(numbers, ::testing::ElementsAre(10, 11, 12, 14, 15)) << "13 is the lost one";
}

TEST(StageScan, ThatCannotMoveEndsTheRunAndIsNotALostCamera) {
  const auto moves = std::make_shared<MovesOfStage>();
  OpenedBench bench = remembering_bench(moves, {1, 2, 3});
  ASSERT_TRUE(scan_with_stage(bench, {.steps = 2, .pixel_mm = 0.8, .frames_after_move = 0}));
  ASSERT_TRUE(bench.target->present({}, {}));
  moves->fails = true;

  const auto frame = bench.camera->next({});

  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::integrity);
  EXPECT_THAT(frame.error().message, HasSubstr("moving the stage within a pixel"));
}

TEST(StageScan, NeedsAStage) {
  OpenedBench bench = remembering_bench(std::make_shared<MovesOfStage>(), {}, false);
  const auto refused = scan_with_stage(bench, {.steps = 2, .pixel_mm = 0.8});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
