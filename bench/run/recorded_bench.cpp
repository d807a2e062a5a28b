#include "bench/run/recorded_bench.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/recording_camera.h"
#include "bench/session/provenance.h"

namespace todbench {
namespace {

constexpr const char* target_key = "target";
constexpr const char* sets_shift_key = "target_sets_shift";
constexpr const char* simulated_key = "simulated";
constexpr const char* comes_back_key = "camera_comes_back";
constexpr const char* frames_meanwhile_key = "frames_while_presenting";

/// A reading that says how waiting for a lost camera ended.
constexpr std::int64_t stayed_away = 0, came_back = 1;

std::string yes_no(bool value) {
  return value ? "yes" : "no";
}

/// Shows nothing: what it showed is in the frames.
class RecordedTarget final : public Target {
 public:
  explicit RecordedTarget(TargetCapabilities capabilities) : capabilities_(std::move(capabilities)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the target was presented");
    return PresentedTarget{
        .state = state, .plate_temperature_k = std::nullopt, .black_body_temperature_k = std::nullopt, .settling_s = 0};
  }

 private:
  TargetCapabilities capabilities_;
};

/// Readings of then, one after the other, whoever asks.
struct Readings {
  std::vector<std::int64_t> values;
  std::size_t next = 0;
  /// Nothing behind the last one.
  std::optional<std::int64_t> take() { return next < values.size() ? std::optional(values[next++]) : std::nullopt; }
};

}  // namespace

std::filesystem::path recorded_frames(const std::filesystem::path& session) {
  return session / "frames" / "camera.todrec";
}

Result<void> record_bench(OpenedBench& bench, const std::filesystem::path& session) {
  const std::filesystem::path file = recorded_frames(session);
  std::error_code problem;
  std::filesystem::create_directories(file.parent_path(), problem);
  if (problem) return fail(ErrorCode::io, file.parent_path().string() + ": cannot be created: " + problem.message());
  StreamHeader header;
  header.info = bench.camera->info();
  header.created_utc = utc_now();
  header.created_host_ns = bench.now_ns();
  header.annotations = {{target_key, bench.target->capabilities().description},
                        {sets_shift_key, yes_no(bench.target->capabilities().sets_shift)},
                        {simulated_key, yes_no(bench.simulated)},
                        {comes_back_key, yes_no(bench.camera_return.recover != nullptr)},
                        {frames_meanwhile_key, yes_no(bench.frames_while_presenting == FramesMeanwhile::take)}};
  auto writer = FrameStreamWriter::create(file, header);
  if (!writer) return tl::unexpected(writer.error());
  const auto stream = std::make_shared<FrameStreamWriter>(*std::move(writer));
  bench.camera = recording_camera(std::move(bench.camera), stream);
  bench.now_ns = [stream, clock = std::move(bench.now_ns)] {
    const std::int64_t now = clock();
    // A reading that the disk refuses ends the recording, and with it the next frame fails.
    (void)stream->append_reading(now);
    return now;
  };
  bench.remember_rest = [stream](bool rests) {
    (void)stream->append_reading(rests ? 1 : 0);
    return rests;
  };
  bench.remember_calls = [stream](std::int64_t calls) {
    (void)stream->append_reading(calls);
    return calls;
  };
  if (bench.camera_return.recover) {
    bench.camera_return.recover = [stream, recover = std::move(bench.camera_return.recover)](std::stop_token stop) {
      auto back = recover(std::move(stop));
      (void)stream->append_reading(back ? came_back : stayed_away);
      return back;
    };
  }
  return {};
}

Result<OpenedBench> open_recorded_bench(const std::filesystem::path& session) {
  const std::filesystem::path file = recorded_frames(session);
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) {
    return fail(ErrorCode::invalid_input, session.string() +
                                              ": no frames were recorded in this session ([measurement] "
                                              "record_frames or --record-frames)");
  }
  auto stream = open_frame_stream(file);
  if (!stream) return tl::unexpected(stream.error());
  auto& annotations = stream->header.annotations;
  if (!annotations.contains(sets_shift_key))
    return fail(ErrorCode::invalid_input, file.string() + ": not the recording of a measurement");
  TargetCapabilities capabilities;
  capabilities.description = annotations[target_key];
  capabilities.sets_shift = annotations[sets_shift_key] == "yes";
  OpenedBench bench;
  bench.simulated = annotations[simulated_key] == "yes";
  bench.target = std::make_unique<RecordedTarget>(std::move(capabilities));
  const auto readings = std::make_shared<Readings>(Readings{.values = std::move(stream->readings)});
  // Behind the last reading time stands still and nobody rests: the frames end there too.
  const std::int64_t last = readings->values.empty() ? 0 : readings->values.back();
  bench.now_ns = [readings, last] { return readings->take().value_or(last); };
  bench.remember_rest = [readings](bool) { return readings->take().value_or(0) == 1; };
  if (annotations[frames_meanwhile_key] == "yes") {
    bench.frames_while_presenting = FramesMeanwhile::repeat;
    bench.remember_calls = [readings](std::int64_t) { return readings->take().value_or(0); };
  }
  if (annotations[comes_back_key] == "yes") {
    bench.camera_return.recover = [readings](const std::stop_token&) -> Result<void> {
      if (readings->take().value_or(stayed_away) == came_back) return {};
      return fail(ErrorCode::disconnected, "the recorded camera was lost and did not come back");
    };
  }
  bench.camera = recorded_source(std::move(stream->recording), Playback::replay);
  return bench;
}

}  // namespace todbench
