// SPDX-License-Identifier: GPL-3.0-or-later
// Runs in which nothing changes and the stage is right: how often a check says otherwise.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "acquisition/base/host_clock.h"
#include "acquisition/core/forwarding_source.h"
#include "tests/tod/measurement/measurement_bench.h"
#include "tod/measurement/run_constancy.h"

namespace todbench::test {

struct RightCamera {
  std::string name;
  SensorSpec spec = sc2000();
};

/// Plain, with patterns larger than the noise, with noise that lines share, with noise that the next frames remember,
/// and with small detectors, whose pictures of triangles depend most on the phase.
inline std::vector<RightCamera> right_cameras() {
  std::vector<RightCamera> cameras{{"SC2000"},
                                   {"fixed pattern 0.1 K"},
                                   {"row and column noise 0.05 K"},
                                   {"noise correlation 0.6"},
                                   {"detectors of 0.6 pitch"}};
  cameras[4].spec.detector_um = 0.6 * cameras[4].spec.pitch_um;
  cameras[1].spec.fixed_pattern_k = 0.1;
  cameras[2].spec.row_noise_k = cameras[2].spec.column_noise_k = 0.05;
  cameras[3].spec.noise_correlation = 0.6;
  return cameras;
}

/// Runs with a false alarm of each check.
struct FalseAlarms {
  int runs = 0;
  int place = 0;     ///< refused
  int followed = 0;  ///< judged by another place than the one asked for
  int transfer = 0, presented = 0, noise = 0, correlation = 0, residue = 0;
  double largest_presented = 0;  ///< largest change of the contrast of the presentations relative to its limit
  [[nodiscard]] std::array<int, 7> all() const {
    return {place, followed, transfer, presented, noise, correlation, residue};
  }
};

/// Exposures from `first` on. Pictures of one model are formed once for all runs.
class RightSource final : public ForwardingSource {
 public:
  using Pictures = std::map<std::array<double, 4>, std::shared_ptr<const cv::Mat1f>>;
  RightSource(std::shared_ptr<const SensorModel> model, std::shared_ptr<SceneHolder> holder, Pictures& pictures,
              std::uint64_t first)
      : ForwardingSource(simulated_source(model, holder, "1")),
        model_(std::move(model)),
        holder_(std::move(holder)),
        scale_(std::make_shared<const RadiometricScale>(info().scale)),
        pictures_(pictures),
        first_(first) {}

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds /*timeout*/) override {
    const auto scene = holder_->scene();
    const cv::Point2d& hangs = scene->plate.triangles.front().position_mm;
    auto& picture = pictures_[{hangs.x, hangs.y, scene->shift_mm.x, scene->shift_mm.y}];
    if (!picture) picture = model_->unit_signal(*scene);
    Frame frame;
    frame.counts = model_->expose(*picture, scene->delta_t_k, scene->background_k, first_ + exposures_);
    frame.sequence = exposures_;
    frame.device_time_ns = static_cast<std::int64_t>(static_cast<double>(exposures_++) * 1e9 / info().frame_rate_hz);
    frame.host_time_ns = monotonic_ns();
    frame.significant_bits = info().significant_bits;
    frame.scale = scale_;
    return frame;
  }

 private:
  std::shared_ptr<const SensorModel> model_;
  std::shared_ptr<SceneHolder> holder_;
  std::shared_ptr<const RadiometricScale> scale_;
  Pictures& pictures_;
  std::uint64_t first_ = 0, exposures_ = 0;
};

/// `runs` runs before one camera with its own fixed pattern (`seed`), each with its own noise: two set-ups, two
/// contrasts, the lower one near the noise, four places each.
inline FalseAlarms right_runs(const RightCamera& camera, std::uint64_t seed, int runs) {
  SimulatedBench bench;
  bench.spec = camera.spec;
  bench.plates = {two_plates().front()};
  bench.mountings = {Mounting::identity, Mounting::rotated_180};
  bench.contrasts = {16.9, 0.5};
  bench.seed = seed;
  const auto model =
      std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::draft(), seed);
  MeasurementOptions options = options_of(bench);
  options.max_shift_error_px = 0.25;
  RightSource::Pictures pictures;
  FalseAlarms out;
  constexpr std::uint64_t exposures_of_a_run = 1000;
  for (int run = 0; run < runs; ++run) {
    PlateScene scene;
    scene.plate = bench.plates.front();
    scene.distance_m = bench.distance_m;
    const auto holder = std::make_shared<SceneHolder>(scene);
    RightSource source(model, holder, pictures, exposures_of_a_run * static_cast<std::uint64_t>(run));
    const auto target = scene_target(holder, bench.plates);
    ListedSchedule schedule = schedule_of(bench);
    TemplateObserver observer({}, triangle_alternatives());
    const auto result = measure(source, *target, observer, schedule, options, *bench.host, {}, {});
    if (!result) {
      ADD_FAILURE() << camera.name << ", seed " << seed << ", run " << run << ": " << result.error().message;
      return out;
    }
    const auto beyond = [](const auto& figure) { return figure && figure->beyond() ? 1 : 0; };
    const auto& residue = result->constancy.residue;
    ++out.runs;
    out.place += result->ended_by ? 1 : 0;
    for (const std::string& note : result->notes)
      out.followed += note.find("px from the requested place") != std::string::npos ? 1 : 0;
    out.transfer += beyond(transfer_change(result->contrasts));
    const auto presented = presented_change(result->constancy.presented);
    out.presented += beyond(presented);
    if (presented)
      out.largest_presented = std::max(out.largest_presented, std::abs(presented->value) / presented->limit);
    out.noise += beyond(noise_change(result->constancy.noise));
    out.correlation += beyond(correlation_change(result->constancy.noise));
    out.residue += residue && residue->share > residue->limit ? 1 : 0;
  }
  return out;
}

}  // namespace todbench::test
