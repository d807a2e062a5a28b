// SPDX-License-Identifier: GPL-3.0-or-later
// A small bench on a simulated camera whose frames pass through a fault.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "tests/tod/measurement/measurement_bench.h"

namespace todbench::test {

/// What a fault does to the frame with this index: hands it on, changes it, or fails.
using Fault = std::function<Result<Frame>(std::uint64_t index, Frame frame)>;

/// A simulated camera whose frames pass through a fault.
class DisturbedSource final : public FrameSource {
 public:
  DisturbedSource(std::unique_ptr<FrameSource> camera, Fault fault)
      : camera_(std::move(camera)), fault_(std::move(fault)) {}
  [[nodiscard]] const SourceInfo& info() const override { return info_ ? *info_ : camera_->info(); }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = camera_->next(timeout);
    if (!frame) return frame;
    return fault_(index_++, std::move(*frame));
  }
  void stop() override { camera_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return camera_->get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return camera_->set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override {
    ++corrections;
    if (!takes_commands) return fail(ErrorCode::invalid_input, "there is no such command");
    return {};
  }
  void pretend(SourceInfo info) { info_ = std::move(info); }
  int corrections = 0;
  bool takes_commands = true;

 private:
  std::unique_ptr<FrameSource> camera_;
  Fault fault_;
  std::optional<SourceInfo> info_;
  std::uint64_t index_ = 0;
};

/// One plate, one mounting, two contrasts, a few phases: enough to see what happens.
struct SmallBench : SimulatedBench {
  std::shared_ptr<SceneHolder> holder;
  std::shared_ptr<const SensorModel> model;
  SmallBench() {
    plates = {two_plates().front()};
    mountings = {Mounting::identity};
    contrasts = {16.9, 1.93};
    phases = 3;
    PlateScene scene;
    scene.plate = plates.front();
    holder = std::make_shared<SceneHolder>(scene);
    model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), seed);
  }
  [[nodiscard]] std::unique_ptr<FrameSource> camera() const { return simulated_source(model, holder, "1"); }
  [[nodiscard]] Result<MeasurementResult> run(FrameSource& source, const MeasurementOptions& options,
                                              const MeasurementListener& listener = {},
                                              std::stop_token stop = {}) const {
    const auto target = scene_target(holder, plates);
    return run(source, *target, options, listener, stop);
  }
  [[nodiscard]] Result<MeasurementResult> run(FrameSource& source, Target& target, const MeasurementOptions& options,
                                              const MeasurementListener& listener = {},
                                              std::stop_token stop = {}) const {
    TemplateObserver observer({}, triangle_alternatives());
    ListedSchedule schedule = schedule_of(*this);
    return measure(source, target, observer, schedule, options, *host, listener, stop);
  }
};

}  // namespace todbench::test
