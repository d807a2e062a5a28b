// SPDX-License-Identifier: GPL-3.0-or-later
// A whole run that loses its camera: what the session and the report say, what a replay makes of it, and how it ends on
// request while the camera is away.
#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "bench/devices/emulation.h"
#include "bench/judgement/verdict.h"
#include "bench/run/recorded_bench.h"
#include "bench/run/replay.h"
#include "tests/support/patience.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/verify_manifest.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using testing::content_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Plan short_plan() {
  auto plan = *load_plan("demo");
  plan.fit.estimator = EstimatorChoice::weibull;  // not of the function of the twin, which takes longer than the rest
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9};
  plan.target.phases = 6;
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 4;
  plan.measurement.registration_frames = 4;
  plan.measurement.contrast_frames = 4;
  plan.camera.nuc_interval_s = 3600;
  plan.camera.nuc_wait_s = 0.6;  // the camera repeats its picture for 0.5 s
  plan.limits = {};
  return plan;
}

/// The laboratory with an Ax5-like camera whose cable is pulled after the second presentation.
class LostCamera : public ::testing::Test {
 protected:
  void SetUp() override {
    EmulationArguments arguments = emulation_for(plan_);
    arguments.camera = "gige-ax5";
    auto started = start_laboratory(arguments);
    ASSERT_TRUE(started) << started.error().message;
    laboratory_ = *std::move(started);
    plan_ = with_laboratory(std::move(plan_), *laboratory_);
    listener_.on_progress = [this](std::size_t done, std::size_t) {
      if (done == 2) laboratory_->switch_camera_off();
    };
    listener_.on_note = [this](std::string_view sentence) { notes_.emplace_back(sentence); };
  }

  [[nodiscard]] ExperimentOptions folder(const std::string& name) const {
    return {.folder = folder_.path() / name, .existing = ExistingFolder::refuse};
  }

  testing::TemporaryFolder folder_;
  Plan plan_ = short_plan();
  std::unique_ptr<Laboratory> laboratory_;
  ExperimentListener listener_;
  std::vector<std::string> notes_;
};

TEST_F(LostCamera, ThatComesBackMakesACompleteSessionInTwoSegmentsThatReplaysBitForBit) {
  plan_.measurement.record_frames = true;
  listener_.on_lost = [this](const SourceInfo& camera, std::chrono::milliseconds patience) {
    EXPECT_EQ(camera.serial, "TB0001");
    EXPECT_EQ(patience, 60s);
    EXPECT_TRUE(laboratory_->switch_camera_on());
  };

  const auto run = measure_plan(plan_, folder("m"), listener_, {});

  ASSERT_TRUE(run) << run.error().message;
  ASSERT_FALSE(run->ended_by) << run->ended_by->message;
  EXPECT_EQ(exit_code(run->verdict.decision), 0);
  EXPECT_THAT(notes_, Contains(HasSubstr("camera lost, waiting 60 s for")));
  EXPECT_THAT(content_of(folder_.path() / "m" / "log.txt"), HasSubstr("with serial number TB0001"));
  const auto session = read_session(folder_.path() / "m");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_TRUE(session->complete());
  EXPECT_EQ(session->trials.size(), 6u * 20u);
  EXPECT_TRUE(was_interrupted(session->provenance));
  EXPECT_EQ(segments(session->provenance), 2u);
  EXPECT_EQ(session->provenance.run->interruptions.front().presentation, 2);
  const Json provenance = Json::parse(content_of(folder_.path() / "m" / "provenance.json"));
  EXPECT_EQ(provenance["state"], "complete");
  EXPECT_EQ(provenance["interrupted"], true);
  EXPECT_EQ(provenance["segments"], 2);
  EXPECT_THAT(content_of(folder_.path() / "m" / "report.html"),
              HasSubstr("<b>Interrupted and resumed:</b> segment 2 begins with presentation 2."));

  const auto replay = replay_session(folder_.path() / "m", folder("r"), {}, {});

  ASSERT_TRUE(replay) << replay.error().message;
  EXPECT_FALSE(replay->run.ended_by) << replay->run.ended_by->message;
  EXPECT_TRUE(replay->same_trials);
  EXPECT_EQ(replay->same_fits, true);
  const auto again = read_session(folder_.path() / "r");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(segments(again->provenance), 2u);
}

TEST_F(LostCamera, ThatStaysAwayEndsTheRunAndItsReplayAlike) {
  plan_.measurement.record_frames = true;
  plan_.camera.reconnect_s = 0.2;

  const auto run = measure_plan(plan_, folder("m"), listener_, {});
  const auto replay = replay_session(folder_.path() / "m", folder("r"), {}, {});

  ASSERT_TRUE(run) << run.error().message;
  ASSERT_TRUE(run->ended_by);
  EXPECT_EQ(exit_code(run->ended_by->code), 5);
  EXPECT_THAT(verify_manifest(folder_.path() / "m").value(), IsEmpty());
  ASSERT_TRUE(replay) << replay.error().message;
  ASSERT_TRUE(replay->run.ended_by);
  EXPECT_EQ(exit_code(replay->run.ended_by->code), 5);
  EXPECT_TRUE(replay->same_trials);
}

/// Requests a stop some time after it was told to: by then another state of the reconnection is reached.
class AbortLater {
 public:
  AbortLater(std::stop_source stop, std::chrono::milliseconds later)
      : thread_([this, stop, later](const std::stop_token& gone) mutable {
          std::unique_lock lock(mutex_);
          if (!changed_.wait(lock, gone, [this] { return told_; })) return;
          changed_.wait_for(lock, gone, later, [] { return false; });
          asked_ = std::chrono::steady_clock::now();
          stop.request_stop();
        }) {}
  void begin() {
    const std::lock_guard lock(mutex_);
    told_ = true;
    changed_.notify_all();
  }
  [[nodiscard]] std::chrono::steady_clock::time_point asked() {
    const std::lock_guard lock(mutex_);
    return asked_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool told_ = false;
  std::chrono::steady_clock::time_point asked_{};
  std::jthread thread_;
};

class AbortedWhileLost : public LostCamera, public ::testing::WithParamInterface<int> {};

TEST_P(AbortedWhileLost, EndsWithinASecondWithAValidPartialSession) {
  std::stop_source stop;
  AbortLater abort(stop, std::chrono::milliseconds(GetParam()));
  listener_.on_lost = [&](const SourceInfo&, std::chrono::milliseconds) { abort.begin(); };

  const auto run = measure_plan(plan_, folder("m"), listener_, stop.get_token());
  const auto ended = std::chrono::steady_clock::now();

  ASSERT_TRUE(run) << run.error().message;
  ASSERT_TRUE(run->ended_by);
  EXPECT_EQ(exit_code(run->ended_by->code), 130);
  EXPECT_LT(ended - abort.asked(), testing_support::patience(1s));
  EXPECT_THAT(verify_manifest(folder_.path() / "m").value(), IsEmpty());
  const auto session = read_session(folder_.path() / "m");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->provenance.state, SessionState::interrupted);
  EXPECT_EQ(session->trials.size(), 2u * 20u);
}

// The connection is being released; it is waited or opened again; a later attempt is under way.
INSTANTIATE_TEST_SUITE_P(AfterMs, AbortedWhileLost, ::testing::Values(0, 300, 1500));

}  // namespace
}  // namespace todbench
