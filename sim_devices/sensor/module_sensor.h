// SPDX-License-Identifier: GPL-3.0-or-later
// Sensor simulated by a program of the user. The program receives a scene and returns a frame.
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

/// Samples per detector pitch along each axis, in the scene that the program receives.
inline constexpr int scene_samples_per_pitch = 4;

/// Returns the program that simulates the sensor; null if the sensor has no program.
[[nodiscard]] const ModulePlan* sensor_module(const SensorSpec& spec);
/// Checks that the program can simulate this sensor and scene. Succeeds if the sensor has no program. Error:
/// `invalid_input` for microscan, super-resolution or a moving scene.
[[nodiscard]] Result<void> check_sensor_module(const SensorSpec& spec, SceneMotion motion = {});

/// Returns the facts that the program receives at its start: the numbers of the sensor file by key, `ifov_mrad`,
/// `ifov_y_mrad`, `scene_samples_per_pitch` and `seed`.
[[nodiscard]] std::vector<SensorFact> sensor_facts(const SensorSpec& spec, std::uint64_t seed);

/// Returns the scene in kelvin above its surround. Each detector is divided into scene_samples_per_pitch by
/// scene_samples_per_pitch squares; a sample is the exact mean over one square. The size is (width, height) times
/// scene_samples_per_pitch. Sample (0, 0) is in the corner of detector (0, 0).
[[nodiscard]] cv::Mat1f scene_picture_k(const PlateScene& scene, const SensorSpec& spec);

/// Runs the program of a sensor. The first call of picture() starts the program. One thread at a time.
class ModuleSensor {
 public:
  /// Receives each line that the program writes to standard error.
  using OnLine = std::function<void(std::string_view line)>;
  /// Stores the sensor and the seed; does not start the program. Precondition: sensor_module(spec).
  ModuleSensor(SensorSpec spec, std::uint64_t seed, OnLine on_error_line);

  /// Returns frame `index` of a scene from scene_picture_k(), in kelvin above the surround. Errors: module_error().
  [[nodiscard]] Result<cv::Mat1f> picture(const cv::Mat1f& scene_k, std::uint64_t index);
  /// Returns frame `index` of a scene, in counts. Errors: those of picture(); `invalid_input` for a moving scene.
  [[nodiscard]] Result<cv::Mat1w> expose(const PlateScene& scene, std::uint64_t index);

 private:
  SensorSpec spec_;                                       ///< the simulated sensor
  ModuleStageOptions options_;                            ///< command, facts and restarts of the program
  std::optional<ModuleProcess> process_;                  ///< the running program; empty before its first start
  int answered_ = 0;                                      ///< frames since the last start of the program
  std::optional<std::pair<PlateScene, cv::Mat1f>> last_;  ///< the last exposed scene and its scene_picture_k()
};

}  // namespace todbench
