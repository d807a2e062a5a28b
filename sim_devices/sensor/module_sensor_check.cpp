// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/module_sensor_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::uint64_t check_seed = 1;

SensorSpec sized(SensorSpec spec, cv::Size size) {
  spec.width = size.width;
  spec.height = size.height;
  return spec;
}

cv::Mat1f random_scene(cv::Size frame, std::uint64_t index) {
  cv::Mat1f scene(frame * scene_samples_per_pitch);
  RandomStream(1, "module.sensor.check").sub(index).fill_normal({scene.ptr<float>(), scene.total()});
  return scene;
}

/// Answers of a new process to the scenes as frames 0, 1, ...
Result<std::vector<cv::Mat1f>> frames_of(const SensorSpec& spec, const std::vector<cv::Mat1f>& scenes) {
  ModuleSensor sensor(spec, check_seed, {});
  std::vector<cv::Mat1f> frames;
  for (const cv::Mat1f& scene : scenes) {
    auto frame = sensor.picture(scene, frames.size());
    if (!frame)
      return fail(fmt::format("frame {} of {} x {} pixels", frames.size(), spec.width, spec.height), frame.error());
    frames.push_back(*std::move(frame));
  }
  return frames;
}

Result<double> frame_time_ms(const SensorSpec& spec) {
  ModuleSensor sensor(spec, check_seed, {});
  const cv::Mat1f scene = random_scene({spec.width, spec.height}, 9);
  std::vector<double> times;
  for (std::uint64_t i = 0; i < 21; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    TODBENCH_TRY_VOID(sensor.picture(scene, i));
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  std::nth_element(times.begin() + 1, times.begin() + 11, times.end());  // the first includes the start
  return times[11];
}

Result<void> look_at_numbers(const SensorSpec& spec, SensorModuleReport& report) {
  const cv::Size size(spec.width, spec.height);
  const cv::Mat1f zero = cv::Mat1f::zeros(size * scene_samples_per_pitch), one = zero + 1.0F;
  const cv::Mat1f a = random_scene(size, 5), b = random_scene(size, 6);
  std::vector<cv::Mat1f> added;
  for (const cv::Mat1f& scene : {zero, one, a, b, cv::Mat1f(2 * a - 0.5 * b)}) {
    TODBENCH_TRY(auto frames, frames_of(spec, {scene, zero}));
    if (added.empty())
      report.noise_k = cv::norm(frames[1] - frames[0]) / std::sqrt(2 * static_cast<double>(size.area()));
    added.push_back(added.empty() ? frames[0] : cv::Mat1f(frames[0] - added.front()));
  }
  report.response = cv::mean(added[1])[0];
  const auto largest = [](const cv::Mat1f& picture) { return cv::norm(picture, cv::NORM_INF); };
  report.linearity_deviation =
      largest(added[4] - (2 * added[2] - 0.5 * added[3])) / std::max({largest(added[2]), largest(added[3]), 1e-12});
  report.linear = report.linearity_deviation < 1e-4;
  return {};
}

}  // namespace

Result<SensorModuleReport> check_sensor(const SensorSpec& spec) {
  SensorModuleReport report;
  report.network_cut = !sensor_module(spec)->network && can_cut_network();
  for (const cv::Size size : {cv::Size(32, 24), cv::Size(24, 32), cv::Size(160, 120)}) {
    const std::vector<cv::Mat1f> scenes{random_scene(size, 1), random_scene(size, 2)};
    const auto first = frames_of(sized(spec, size), scenes), second = frames_of(sized(spec, size), scenes);
    if (!first) return tl::unexpected(first.error());
    if (!second) return tl::unexpected(second.error());
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      if (cv::norm((*first)[i], (*second)[i], cv::NORM_INF) != 0)
        return fail(ErrorCode::integrity,
                    "two processes of the module answered the same scene, frame and seed differently");
    }
    report.shapes.push_back(size);
  }
  TODBENCH_TRY(report.latency_ms, frame_time_ms(sized(spec, {320, 240})));
  if (auto looked = look_at_numbers(sized(spec, {64, 48}), report); !looked) return tl::unexpected(looked.error());
  return report;
}

}  // namespace todbench
