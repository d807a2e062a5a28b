// SPDX-License-Identifier: GPL-3.0-or-later
// Size-of-source effect: the curve holds the closed form of a known halo, without a halo it is flat. Slopes behind a
// collimator.
#include "tod/camera_measures/source_size.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <memory>
#include <utility>

#include "bench/devices/devices.h"
#include "tests/bench/run/source_size_coverage.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {
namespace {

using testing::source_size_coverage;
using testing::SourceHalo;

TEST(SourceSize, HoldsTheClosedFormOfAHalo) {
  for (const SourceHalo halo : {SourceHalo{0, 1}, SourceHalo{0.05, 10}, SourceHalo{0.1, 30}}) {
    const auto found = source_size_coverage(halo, 1, 0.0015, 2);
    ASSERT_TRUE(found) << found.error().message;
    for (std::size_t k = 0; k < found->sides_px.size(); ++k) {
      std::printf("halo %g %% of %g px, side %g px: truth %.4f, error %+.4f, half-width %.4f, held %.2f\n",
                  100 * halo.share, halo.sigma_px, found->sides_px[k], found->truth[k], found->mean_error[k],
                  found->half_width[k], found->within[k]);
      // Two intervals of 95 %, with fixed seeds: both hold.
      EXPECT_GE(found->within[k], 0.75);
      EXPECT_LT(found->half_width[k], 0.01);
      EXPECT_GE(found->point_within[k], 0.75);
    }
    std::printf("points held %.2f %.2f %.2f, consistent %.2f, reference %+.4f\n", found->point_within[0],
                found->point_within[1], found->point_within[2], found->consistent, found->slope_error);
    EXPECT_NEAR(found->slope_error, 0, 0.002);
  }
}

/// A target whose contrasts lose a part on their way to the camera.
class TargetBehindMirrors final : public Target {
 public:
  TargetBehindMirrors(Target& target, double transmittance) : target_(target), transmittance_(transmittance) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_.capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    TargetState behind = state;
    behind.delta_t_k *= transmittance_;
    auto shown = target_.present(behind, std::move(stop));
    if (shown) shown->state = state;
    return shown;
  }

 private:
  Target& target_;
  double transmittance_;
};

TEST(SourceSize, ItsSlopeAndThatOfTrianglesAreRelativeToTheContrastBehindACollimator) {
  const SensorSpec sensor = *load_sensor("sc2000");
  const TargetPlate plate = *load_plate("tcat-a"), apertures = *load_plate("apertures");
  const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  OpenedBench bench = simulated_bench(model, {plate, apertures}, 2, {});
  TargetBehindMirrors target(*bench.target, 0.85);
  CameraMeasuresOptions options;
  options.transfer = true;
  options.transfer_steps_k = {-8, 4, 8};
  options.source_plate = apertures;
  options.source_frames = 16;
  options.measurement.ifov_mrad = sensor.ifov_mrad();
  options.measurement.distance_m = 2;
  options.measurement.plates = {plate};
  options.measurement.registration_frames = 4;
  options.measurement.air_transmittance = 0.85;

  const auto measures = measure_camera(*bench.camera, target, options, *bench.host, {});

  ASSERT_TRUE(measures) << measures.error().message;
  ASSERT_TRUE(measures->transfer && measures->source);
  // The blur lowers the contrast of triangles by 2 %. Without the transmittance both slopes are 0.85 times as large.
  EXPECT_NEAR(measures->transfer->line.slope, 0.98, 0.01);
  EXPECT_NEAR(measures->source->slope().value, 1, 0.01);
}

}  // namespace
}  // namespace todbench
