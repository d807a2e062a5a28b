// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/stage_scan.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "acquisition/base/host_clock.h"
#include "acquisition/base/try.h"
#include "acquisition/core/forwarding_source.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/super_resolution_stage.h"
#include "tod/presentation/target_failure.h"

namespace todbench {
namespace {

/// Common to the scanning camera and its target. The camera moves the target only while nobody else changes it.
struct ScanState {
  std::unique_ptr<Target> target;
  std::mutex mutex;
  bool changing = false;             ///< present() is under way
  std::optional<TargetState> state;  ///< as last requested and reached
};

class ScannedTarget final : public Target {
 public:
  explicit ScannedTarget(std::shared_ptr<ScanState> shared) : shared_(std::move(shared)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return shared_->target->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    set(true, std::nullopt);
    auto said = shared_->target->present(state, std::move(stop));
    set(false, said ? std::optional(state) : std::nullopt);
    return said;
  }

 private:
  void set(bool changing, std::optional<TargetState> state) {
    const std::scoped_lock lock(shared_->mutex);
    shared_->changing = changing;
    shared_->state = std::move(state);
  }

  std::shared_ptr<ScanState> shared_;
};

class ScanningSource final : public ForwardingSource {
 public:
  ScanningSource(std::unique_ptr<FrameSource> camera, std::shared_ptr<ScanState> shared, const StageScan& scan,
                 bool free_running)
      : ForwardingSource(std::move(camera)), shared_(std::move(shared)), scan_(scan), free_running_(free_running) {}

  [[nodiscard]] Result<void> start() override {
    {
      const std::scoped_lock lock(shared_->mutex);
      stop_ = std::stop_source();
    }
    return ForwardingSource::start();
  }
  void stop() override {
    {
      const std::scoped_lock lock(shared_->mutex);
      stop_.request_stop();
    }
    ForwardingSource::stop();
  }

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    if (const auto state = resting()) {
      TODBENCH_TRY_VOID(move(*state));
      TODBENCH_TRY_VOID(drop_frames_in_flight(timeout));
    }
    auto frame = ForwardingSource::next(timeout);
    if (!frame) return frame;
    ++index_;
    if (frame->sequence < dropped_) dropped_ = 0;  // the camera began to count again
    frame->sequence -= dropped_;
    return frame;
  }

 private:
  /// State of the target between two changes; empty: there is none to move.
  [[nodiscard]] std::optional<TargetState> resting() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->changing ? std::nullopt : shared_->state;
  }

  Result<void> move(TargetState state) {
    state.shift_mm += scan_.pixel_mm * dither_px(scan_.steps, index_);
    std::stop_token stop;
    {
      const std::scoped_lock lock(shared_->mutex);
      stop = stop_.get_token();
    }
    const auto reached = shared_->target->present(state, stop);
    moved_ns_ = monotonic_ns();
    if (reached) return {};
    const bool stopped = reached.error().code == ErrorCode::interrupted;
    // The codes of lost and silent devices are those of the camera here.
    return target_failure("moving the stage within a pixel",
                          with_code(stopped ? ErrorCode::interrupted : ErrorCode::integrity, reached.error()));
  }

  Result<void> drop_frames_in_flight(std::chrono::milliseconds timeout) {
    for (int after = 0; free_running_ && after < scan_.frames_after_move;) {
      TODBENCH_TRY(const auto frame, ForwardingSource::next(timeout));
      ++dropped_;
      if (frame.host_time_ns >= moved_ns_) ++after;
    }
    return {};
  }

  std::shared_ptr<ScanState> shared_;
  StageScan scan_;
  bool free_running_;
  std::stop_source stop_;
  std::uint64_t index_ = 0;  ///< of the next frame, as stages behind this camera count
  std::uint64_t dropped_ = 0;
  std::int64_t moved_ns_ = 0;
};

}  // namespace

Result<std::string> scan_with_stage(OpenedBench& bench, const StageScan& scan) {
  if (!bench.target->capabilities().sets_shift) {
    return fail(ErrorCode::invalid_input, "the target cannot scan a pixel: it has no stage that sets shifts (" +
                                              bench.target->capabilities().description + ")");
  }
  if (!(scan.pixel_mm > 0) || scan.steps < 2)
    return fail(ErrorCode::invalid_input, "a scan needs two places or more and a pixel above 0 mm");
  const auto shared = std::make_shared<ScanState>();
  shared->target = std::move(bench.target);
  bench.camera = std::make_unique<ScanningSource>(std::move(bench.camera), shared, scan, !bench.simulated);
  bench.target = std::make_unique<ScannedTarget>(shared);
  return fmt::format(
      "the stage visits {0} x {0} places of a pixel in turn, one frame at each, in steps of {1:.4g} mm: curve, blur "
      "and noise of this session are those of a scanned picture, not of the camera at rest",
      scan.steps, scan.pixel_mm / scan.steps);
}

std::vector<int> scan_factors(const EnhancementPackage& package) {
  std::vector<int> factors;
  for (const StagePlan& stage : package.stages) {
    if (stage.kind == StagePlan::Kind::super_resolution && stage.super_resolution.shifts == FrameShifts::scan)
      factors.push_back(stage.super_resolution.factor);
  }
  return factors;
}

Result<void> check_scans(const std::vector<EnhancementPackage>& packages, int dither) {
  for (const EnhancementPackage& package : packages) {
    for (const int factor : scan_factors(package)) {
      if (factor == dither) continue;
      return fail(
          ErrorCode::invalid_input,
          fmt::format("package {0}: its scan needs a sensor or a stage that visits {1} x {1} positions (--dither {1})",
                      one_line(package.name), factor));
    }
  }
  return {};
}

Result<std::function<Result<std::string>(OpenedBench&)>> scan_on_opened(const LoadedPlan& loaded, int steps) {
  // The noise of a pixel comes from successive frames, whose edges are at other places of the scan.
  if (loaded.observer().sensor_noise_factor != 1)
    return fail(ErrorCode::invalid_input,
                "an observer whose noise is proportional to the sensor noise cannot judge the frames of a scan");
  TODBENCH_TRY_VOID(require_square_pixels(loaded.sensor(), "a scan by the stage"));
  const StageScan scan{.steps = steps, .pixel_mm = loaded.plan().target.distance_m * loaded.plan().camera.ifov_mrad};
  return [scan](OpenedBench& bench) { return scan_with_stage(bench, scan); };
}

}  // namespace todbench
