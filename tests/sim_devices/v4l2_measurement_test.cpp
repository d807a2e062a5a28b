// A measurement through an emulated V4L2 camera makes the decisions of the simulated camera for the same exposures.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <mutex>

#include "acquisition/v4l2/v4l2_backend.h"
#include "sim_devices/lab/v4l2_camera.h"
#include "sim_devices/lab/v4l2_laboratory.h"
#include "tests/sim_devices/measurement_bench.h"

namespace todbench {
namespace {

using test::options_of;
using test::schedule_of;
using test::SimulatedBench;

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Which scene every exposure of a free-running camera looked at. Thread-safe.
class ExposureLog {
 public:
  void add(std::uint64_t index, std::shared_ptr<const PlateScene> scene) {
    const std::lock_guard lock(mutex_);
    scenes_[index] = std::move(scene);
  }
  [[nodiscard]] std::shared_ptr<const PlateScene> scene(std::uint64_t index) const {
    const std::lock_guard lock(mutex_);
    return scenes_.at(index);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<const PlateScene>> scenes_;
};

/// A source whose other members are of no interest here.
class PlainSource : public FrameSource {
 public:
  explicit PlainSource(SourceInfo info) : info_(std::move(info)) {}
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  void stop() override {}
  [[nodiscard]] Result<std::string> get(const std::string&) override { return fail(ErrorCode::invalid_input, ""); }
  [[nodiscard]] Result<void> set(const std::string&, const std::string&) override {
    return fail(ErrorCode::invalid_input, "");
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return fail(ErrorCode::invalid_input, ""); }

 private:
  SourceInfo info_;
};

/// The frames of a camera that were exposed to the present scene, numbered anew, and which exposures they are: the
/// camera runs freely, so which ones they are differs from run to run.
class PresentScene final : public PlainSource {
 public:
  PresentScene(FrameSource& camera, const SceneHolder& present, const ExposureLog& log)
      : PlainSource(camera.info()), camera_(camera), present_(present), log_(log) {}
  [[nodiscard]] Result<void> start() override { return camera_.start(); }
  void stop() override { camera_.stop(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    for (;;) {
      auto frame = camera_.next(timeout);
      if (!frame) return frame;
      const double seconds = static_cast<double>(frame->device_time_ns) * 1e-9;
      const auto index = static_cast<std::uint64_t>(std::llround(seconds * info().frame_rate_hz)) - 1;
      if (log_.scene(index) != present_.scene()) continue;
      exposures_.push_back(index);
      frame->sequence = exposures_.size() - 1;
      frame->host_time_ns = monotonic_ns();
      return frame;
    }
  }
  [[nodiscard]] const std::vector<std::uint64_t>& exposures() const { return exposures_; }

 private:
  FrameSource& camera_;
  const SceneHolder& present_;
  const ExposureLog& log_;
  std::vector<std::uint64_t> exposures_;
};

/// The simulated camera, exposing the present scene with these indices.
class GivenExposures final : public PlainSource {
 public:
  GivenExposures(SourceInfo info, const SensorModel& model, const SceneHolder& present,
                 std::vector<std::uint64_t> exposures)
      : PlainSource(std::move(info)), model_(model), present_(present), exposures_(std::move(exposures)) {}
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (next_ >= exposures_.size()) return fail(ErrorCode::disconnected, "no exposure left");
    Frame frame;
    frame.counts = model_.expose(*present_.scene(), exposures_[next_]);
    frame.sequence = next_++;
    frame.host_time_ns = monotonic_ns();
    frame.significant_bits = info().significant_bits;
    frame.correction = CorrectionState::idle;
    frame.scale = std::make_shared<const RadiometricScale>(info().scale);
    return frame;
  }

 private:
  const SensorModel& model_;
  const SceneHolder& present_;
  std::vector<std::uint64_t> exposures_;
  std::size_t next_ = 0;
};

class V4l2Measurement : public testing::TestWithParam<VideoCameraKind> {};

TEST_P(V4l2Measurement, DecidesAsTheSimulatedCameraForTheSameExposures) {
  SimulatedBench bench;
  bench.spec = with_counts_of(GetParam(), bench.spec);
  bench.spec.frame_rate_hz = 100;
  bench.contrasts = {1.93, 0.23};
  bench.mountings = {Mounting::identity};
  bench.phases = 3;
  TemplateObserver observer({}, triangle_alternatives());
  MeasurementOptions options = options_of(bench);
  options.registration_frames = 8;
  options.contrast_frames = 8;
  options.frame_timeout = std::chrono::seconds(20);
  const SensorModel model(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::normal(), 1);
  PlateScene empty;
  empty.distance_m = bench.distance_m;
  SceneHolder before_camera(empty);
  ExposureLog log;
  VideoCameraConfig config;
  config.kind = GetParam();
  const auto camera = connect_v4l2(MockSystem::create(), config)(bench.spec, [&](std::uint64_t index) {
    auto scene = before_camera.scene();
    log.add(index, scene);
    return model.expose(*scene, index);
  });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = v4l2_backend()->open((*camera)->id());
  ASSERT_TRUE(source) << source.error().message;
  const auto share = [](SceneHolder& holder) { return std::shared_ptr<SceneHolder>(&holder, [](SceneHolder*) {}); };

  PresentScene fresh(**source, before_camera, log);
  auto schedule = schedule_of(bench);
  const auto measured =
      measure(fresh, *scene_target(share(before_camera), bench.plates), observer, schedule, options, {}, {});
  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by) << measured->ended_by->message;

  SceneHolder before_simulation(empty);
  GivenExposures given(fresh.info(), model, before_simulation, fresh.exposures());
  auto same_schedule = schedule_of(bench);
  const auto simulated =
      measure(given, *scene_target(share(before_simulation), bench.plates), observer, same_schedule, options, {}, {});
  ASSERT_TRUE(simulated) << simulated.error().message;

  ASSERT_GE(measured->trials.size(), 2U * 2 * 3 * 20);  // plates, contrasts, phases, triangles
  ASSERT_EQ(measured->trials.size(), simulated->trials.size());
  for (std::size_t i = 0; i < measured->trials.size(); ++i) {
    const Trial& a = measured->trials[i];
    const Trial& b = simulated->trials[i];
    ASSERT_EQ(a.frame, b.frame) << i;
    ASSERT_EQ(a.triangle, b.triangle) << i;
    ASSERT_EQ(a.answer, b.answer) << i;
    ASSERT_EQ(a.scores, b.scores) << i;
    ASSERT_EQ(a.delta_t_k, b.delta_t_k) << i;
  }
}

std::string name_of(const testing::TestParamInfo<VideoCameraKind>& kind) {
  return kind.param == VideoCameraKind::lepton ? "Lepton" : "TemperatureRows";
}

INSTANTIATE_TEST_SUITE_P(Every, V4l2Measurement,
                         testing::Values(VideoCameraKind::lepton, VideoCameraKind::temperature_rows), name_of);

}  // namespace
}  // namespace todbench
