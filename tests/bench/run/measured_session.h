// SPDX-License-Identifier: GPL-3.0-or-later
// A session with emulated instruments and a simulated camera, measured once more for each test.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "acquisition/recording/frame_stream.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/instrument_description.h"
#include "bench/run/recorded_bench.h"
#include "bench/run/replay.h"
#include "bench/session/manifest.h"
#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/plate_stage.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tests/support/temporary_folder.h"
#include "tests/tod/measurement/fake_clock.h"
#include "tod/instruments/scpi_target.h"

namespace todbench::testing {

inline Plan short_plan() {
  Plan plan = *load_plan("demo");
  plan.camera = {};
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.camera.nuc_interval_s = 3600;
  plan.camera.nuc_wait_s = 0;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9, 1.93};
  plan.target.phases = 3;
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 2;
  plan.measurement.registration_frames = 4;
  plan.measurement.contrast_frames = 4;
  plan.measurement.record_frames = true;
  plan.fit.estimator = EstimatorChoice::weibull;  // the twin's function takes seconds of every run under a sanitizer
  plan.limits = {};
  return plan;
}

/// What the instruments reach is what the simulated camera sees, as the black body really is.
class SceneBehindInstruments final : public Target {
 public:
  SceneBehindInstruments(std::unique_ptr<Target> instruments, std::unique_ptr<Target> scene,
                         const BlackBody& black_body)
      : instruments_(std::move(instruments)), scene_(std::move(scene)), black_body_(black_body) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return instruments_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    auto said = instruments_->present(state, stop);
    if (!said) return said;
    TargetState real = said->state;
    real.delta_t_k = black_body_.state().delta_t_k;
    if (auto shown = scene_->present(real, stop); !shown) return shown;
    return said;
  }

 private:
  std::unique_ptr<Target> instruments_, scene_;
  const BlackBody& black_body_;
};

/// An emulated black body, still drifting within its window and 2 % off its scale, an emulated plate stage, and a
/// simulated camera.
class MeasuredSession : public ::testing::Test {
 protected:
  MeasuredSession() {
    const FakeClock clock(0.01);
    BlackBodyOptions black_body;
    black_body.time_constant_s = 1;
    black_body.stable_dwell_s = 0;
    black_body.real_delta_t_k = [](double indicated_k) { return 1.02 * indicated_k; };
    black_body.now = clock.now();
    black_body_ = BlackBody::start(black_body).value();
    PlateStageOptions stage;
    stage.plates = {"tcat-a"};
    stage.now = clock.now();
    stage_ = PlateStage::start(stage).value();
    ScpiTargetOptions options;
    options.black_body = black_body_->endpoint();
    options.stage = stage_->endpoint();
    options.black_body_table = load_instrument("scpi-black-body").value();
    options.stage_table = load_instrument("scpi-stage").value();
    options.poll_interval = std::chrono::milliseconds(0);
    options.connection = {.connect_timeout = std::chrono::minutes(1), .answer_timeout = std::chrono::minutes(1)};
    options.now = clock.now();
    instruments_ = open_scpi_target(options, {}).value();
  }

  [[nodiscard]] OpenedBench bench(const ExperimentInputs& inputs) {
    const auto spec = load_sensor("sc2000").value();
    auto model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), 1);
    PlateScene scene;
    scene.plate = inputs.plates.front();
    scene.distance_m = plan_.target.distance_m;
    const auto holder = std::make_shared<SceneHolder>(scene);
    OpenedBench out;
    out.camera = simulated_source(std::move(model), holder, "1");
    out.target = std::make_unique<SceneBehindInstruments>(std::move(instruments_), scene_target(holder, inputs.plates),
                                                          *black_body_);
    return out;
  }

  [[nodiscard]] Result<ExperimentOutcome> measure(const std::string& name) {
    const auto loaded = LoadedPlan::load(plan_);
    if (!loaded) return tl::unexpected(loaded.error());
    EffectPlanner planner;
    const auto inputs = experiment_inputs(*loaded, planner);
    if (!inputs) return tl::unexpected(inputs.error());
    return measure_on_bench(*loaded, *inputs, bench(*inputs), options(name), {}, {});
  }
  [[nodiscard]] ExperimentOptions options(const std::string& name) const {
    return {.folder = at(name), .existing = ExistingFolder::refuse};
  }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }

  /// The recording of a session once more, with something changed on the way.
  void rewrite_recording(const std::string& session, const std::function<void(FrameStream&)>& change) const {
    auto stream = open_frame_stream(recorded_frames(at(session)));
    ASSERT_TRUE(stream) << stream.error().message;
    change(*stream);
    const std::filesystem::path other = at(session) / "frames" / "other.todrec";
    auto writer = FrameStreamWriter::create(other, stream->header);
    ASSERT_TRUE(writer) << writer.error().message;
    const auto source = recorded_source(stream->recording, Playback::replay);
    ASSERT_TRUE(source->start());
    for (std::uint64_t i = 0; i < stream->recording.frame_count; ++i) {
      const auto frame = source->next(std::chrono::seconds(1));
      ASSERT_TRUE(frame && writer->append(*frame));
    }
    for (const Reading& reading : stream->readings) ASSERT_TRUE(writer->append_reading(reading));
    std::filesystem::rename(other, recorded_frames(at(session)));
    ASSERT_TRUE(refresh_manifest(at(session), {"frames/camera.todrec"}));
  }

  TemporaryFolder folder_;
  Plan plan_ = short_plan();
  std::unique_ptr<BlackBody> black_body_;
  std::unique_ptr<PlateStage> stage_;
  std::unique_ptr<Target> instruments_;
};

}  // namespace todbench::testing
