// SPDX-License-Identifier: GPL-3.0-or-later
// User's program in place of the sensor. The program receives a scene and returns a frame.
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "sim_devices/module/module_plan.h"
#include "sim_devices/module/module_process.h"
#include "sim_devices/scene/plate_scene.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Samples of the scene per detector pitch and axis that the program receives.
inline constexpr int scene_samples_per_pitch = 4;

/// Returns the program in place of the sensor; null if there is none.
[[nodiscard]] const ModulePlan* sensor_module(const SensorSpec& spec);
/// Checks that the program can simulate this sensor and scene. Errors: `invalid_input` in one sentence for microscan,
/// super-resolution or a moving scene. Succeeds if there is no program.
[[nodiscard]] Result<void> check_sensor_module(const SensorSpec& spec, SceneMotion motion = {});

/// Returns the facts for the header: the numbers of the sensor file by key, `ifov_mrad`, `scene_samples_per_pitch` and
/// the seed.
[[nodiscard]] std::vector<SensorFact> sensor_facts(const SensorSpec& spec, std::uint64_t seed);

/// Returns the scene in kelvin above its surround: exact means over the squares of a grid that is
/// scene_samples_per_pitch times as fine as the detectors. Size: (width, height) times scene_samples_per_pitch; sample
/// (0, 0) is in the corner of detector (0, 0).
[[nodiscard]] cv::Mat1f scene_picture_k(const PlateScene& scene, const SensorSpec& spec);

/// Runs the program of a sensor. The first picture starts it. One thread at a time.
class ModuleSensor {
 public:
  using OnLine = std::function<void(std::string_view line)>;
  /// Precondition: sensor_module(spec).
  ModuleSensor(SensorSpec spec, std::uint64_t seed, OnLine on_error_line);

  /// Returns frame `index` of a scene_picture_k(), in kelvin above the surround. Errors: module_error().
  [[nodiscard]] Result<cv::Mat1f> picture(const cv::Mat1f& scene_k, std::uint64_t index);
  /// Returns frame `index` of a scene, in whole counts. Errors: those of picture(), and `invalid_input` (the scene
  /// moves).
  [[nodiscard]] Result<cv::Mat1w> expose(const PlateScene& scene, std::uint64_t index);

 private:
  SensorSpec spec_;
  ModuleStageOptions options_;
  std::optional<ModuleProcess> process_;
  int answered_ = 0;
  std::optional<std::pair<PlateScene, cv::Mat1f>> last_;  ///< scene and its picture
};

}  // namespace todbench
