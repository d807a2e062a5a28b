// A sensor that is a program of the user's: scene in, frame out.
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

/// Samples of the scene per detector pitch and axis that such a program is given.
inline constexpr int scene_samples_per_pitch = 4;

/// The program that is the sensor; null: there is none.
[[nodiscard]] const ModulePlan* sensor_module(const SensorSpec& spec);
/// `invalid_input` in one sentence where such a program would be asked for what it cannot do: microscan,
/// super-resolution, a scene that moves. Success where there is none.
[[nodiscard]] Result<void> check_sensor_module(const SensorSpec& spec, SceneMotion motion = {});

/// Every number of the sensor file by its key, `ifov_mrad`, `scene_samples_per_pitch` and the seed: what the header
/// says.
[[nodiscard]] std::vector<SensorFact> sensor_facts(const SensorSpec& spec, std::uint64_t seed);

/// The scene in kelvin above its surround, the exact mean over each square of a grid scene_samples_per_pitch times as
/// fine as the detectors: (width, height) times that many samples, sample (0, 0) in the corner of detector (0, 0).
[[nodiscard]] cv::Mat1f scene_picture_k(const PlateScene& scene, const SensorSpec& spec);

/// The program of a sensor, started with the first picture. One thread at a time.
class ModuleSensor {
 public:
  using OnLine = std::function<void(std::string_view line)>;
  /// Precondition: sensor_module(spec).
  ModuleSensor(SensorSpec spec, std::uint64_t seed, OnLine on_error_line);

  /// What it makes of a scene_picture_k() as frame `index`, in kelvin above the surround. Errors: module_error().
  [[nodiscard]] Result<cv::Mat1f> picture(const cv::Mat1f& scene_k, std::uint64_t index);
  /// The same of a scene, in whole counts. `invalid_input`: it moves.
  [[nodiscard]] Result<cv::Mat1w> expose(const PlateScene& scene, std::uint64_t index);

 private:
  SensorSpec spec_;
  ModuleStageOptions options_;
  std::optional<ModuleProcess> process_;
  int answered_ = 0;
  std::optional<std::pair<PlateScene, cv::Mat1f>> last_;  ///< scene and its picture
};

}  // namespace todbench
