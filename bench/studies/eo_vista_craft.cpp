// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/eo_vista_craft.h"

#include <fmt/format.h>

#include <cmath>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/scene_descriptions.h"

namespace todbench {
namespace {

constexpr double normal_range_m = 400, microscan_range_m = 640;
constexpr double shown_m = 13.5;  ///< side of every picture, to the next even number of pitches
constexpr double raised_m = 1;    ///< height of the water line above the picture's centre: keeps the sky out

Result<ScenePictures> craft_seen(const FieldScene& scene, SensorSpec sensor, int microscan, double range_m,
                                 Accuracy accuracy, std::uint64_t seed) {
  sensor.microscan = microscan;
  ScenePicturesTask task;
  task.scene = scene;
  task.sensor = sensor;
  task.view.range_m = range_m;
  task.view.centre_pitch.y = -raised_m * 1e3 / (range_m * sensor.ifov_mrad());
  task.accuracy = accuracy;
  task.seed = seed;
  task.field_pitch = 2 * static_cast<int>(std::lround(shown_m * 1e3 / (range_m * sensor.ifov_mrad()) / 2));
  return scene_pictures(task);
}

}  // namespace

Result<std::vector<CraftPicture>> eo_vista_craft(Accuracy accuracy, std::uint64_t seed) {
  const auto scene = load_scene("craft-at-sea", [](const std::string& path) -> Result<StoredPicture> {
    return fail(ErrorCode::invalid_input, path + ": expected a scene of polygons");
  });
  if (!scene) return tl::unexpected(scene.error());
  const auto sensor = load_sensor("sc2000");
  if (!sensor) return tl::unexpected(sensor.error());
  TODBENCH_TRY(const auto normal, craft_seen(*scene, *sensor, 1, normal_range_m, accuracy, seed));
  TODBENCH_TRY(const auto finer, craft_seen(*scene, *sensor, 2, microscan_range_m, accuracy, seed));
  const auto display = [](const ScenePictures& pictures) { return pictures.stages[5].kelvin; };
  const double low = std::min(normal.grey_low_k, finer.grey_low_k);
  // Half of the warmest spot; otherwise the hull would be almost black.
  const double high = 0.5 * std::max(normal.grey_high_k, finer.grey_high_k);
  const std::string scale =
      fmt::format("Black: {:.2g} K above the water. White: at least {:.2g} K above it.", low, high);
  return std::vector<CraftPicture>{
      {"figure-12-scene", "The craft at the sensor", "craft-01, side view, without a camera. " + scale, 0,
       normal.stages.front().kelvin, low, high},
      {"figure-12-sc2000", "SC2000 at 400 m", "As displayed. " + scale, normal_range_m, display(normal), low, high},
      {"figure-12-microscan", "SC2000 with 2 x 2 microscan at 640 m", "As displayed. " + scale, microscan_range_m,
       display(finer), low, high}};
}

}  // namespace todbench
