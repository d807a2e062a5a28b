// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/module_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>

#include "acquisition/base/try.h"
#include "hvs/shape/painted_shapes.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/sensor_key.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"

namespace todbench {

const ModulePlan* sensor_module(const SensorSpec& spec) {
  const bool has = !spec.modules.empty() && spec.modules.front().place == ModulePlace::sensor;
  return has ? &spec.modules.front() : nullptr;
}

Result<void> check_sensor_module(const SensorSpec& spec, SceneMotion motion) {
  if (sensor_module(spec) == nullptr) return {};
  if (spec.samples_per_pitch() != 1)
    return fail(ErrorCode::invalid_input,
                "a sensor module answers one sample per detector and supports neither microscan nor super-resolution");
  if (motion != SceneMotion{})
    return fail(ErrorCode::invalid_input, "a sensor module supports only a scene without motion");
  return {};
}

std::vector<SensorFact> sensor_facts(const SensorSpec& spec, std::uint64_t seed) {
  std::vector<SensorFact> facts;
  for (const SensorKey& key : sensor_keys()) {
    std::visit(
        [&](auto member) {
          using Value = std::remove_cvref_t<decltype(spec.*member)>;
          if constexpr (std::is_same_v<Value, double>) facts.push_back({std::string(key.name), spec.*member});
          if constexpr (std::is_same_v<Value, int>)
            facts.push_back({std::string(key.name), std::int64_t{spec.*member}});
        },
        key.member);
  }
  facts.push_back({"ifov_mrad", spec.ifov_mrad()});
  facts.push_back({"ifov_y_mrad", spec.ifov_mrad(PitchAxis::y)});
  facts.push_back({"scene_samples_per_pitch", std::int64_t{scene_samples_per_pitch}});
  facts.push_back({"seed", seed});
  return facts;
}

cv::Mat1f scene_picture_k(const PlateScene& scene, const SensorSpec& spec) {
  constexpr int fine = scene_samples_per_pitch;
  const cv::Size size(spec.width * fine, spec.height * fine);
  PlateScene finer = scene;
  finer.centre_px *= fine;
  const cv::Point2d fine_mrad = sample_mrad(spec) / fine;
  std::vector<PaintedPolygon> painted;
  const auto paint = [&](Polygon outline_on_plate_mm) {
    for (auto& corner : outline_on_plate_mm) corner = scene_pixel(finer, corner, fine_mrad, size);
    painted.push_back({std::move(outline_on_plate_mm), 1});
  };
  for (const auto& t : scene.plate.triangles) paint(triangle(t.size_mm, t.apex, t.position_mm));
  for (const PlateRectangle& rectangle : straight_cut_outs(scene.plate)) paint(outline_mm(rectangle));
  cv::Mat1f picture;
  SceneImager::means(visible_edges(painted), size).convertTo(picture, CV_32F, scene.delta_t_k);
  return picture;
}

ModuleSensor::ModuleSensor(SensorSpec spec, std::uint64_t seed, OnLine on_error_line) : spec_(std::move(spec)) {
  const auto facts = sensor_facts(spec_, seed);
  options_ = stage_options(*sensor_module(spec_), facts);
  options_.process.on_error_line = std::move(on_error_line);
}

Result<cv::Mat1f> ModuleSensor::picture(const cv::Mat1f& scene_k, std::uint64_t index) {
  const ModulePlan& module = *sensor_module(spec_);
  if (options_.restart_frames > 0 && answered_ >= options_.restart_frames) process_.reset();
  if (!process_) {
    auto started = ModuleProcess::start(options_.process);
    if (!started) return tl::unexpected(module_error(module, started.error()));
    process_.emplace(*std::move(started));
    answered_ = 0;
  }
  const auto frame = static_cast<double>(index);
  const auto answer =
      process_->ask(to_message(std::vector<double>{frame, frame / spec_.frame_rate_hz}) + to_message(scene_k),
                    {static_cast<std::size_t>(spec_.height), static_cast<std::size_t>(spec_.width)});
  if (!answer) return tl::unexpected(module_error(module, answer.error()));
  ++answered_;
  cv::Mat1f picture(spec_.height, spec_.width);
  std::transform(answer->begin(), answer->end(), picture.begin(),
                 [](double value) { return static_cast<float>(value); });
  // A finite double may be infinite as a float.
  if (!cv::checkRange(picture))
    return tl::unexpected(
        module_error(module, {ErrorCode::integrity, "the module answered with a number that is not finite"}));
  return picture;
}

Result<cv::Mat1w> ModuleSensor::expose(const PlateScene& scene, std::uint64_t index) {
  TODBENCH_TRY_VOID(check_sensor_module(spec_, scene.motion));
  if (!last_ || last_->first.delta_t_k != scene.delta_t_k || !same_geometry(last_->first, scene))
    last_.emplace(scene, scene_picture_k(scene, spec_));
  TODBENCH_TRY(const auto kelvin, picture(last_->second, index));
  const Quantiser quantiser(spec_, scene.background_k);
  cv::Mat1w counts(kelvin.size());
  std::transform(kelvin.begin(), kelvin.end(), counts.begin(), [&](float value) { return quantiser.count(value); });
  return counts;
}

}  // namespace todbench
