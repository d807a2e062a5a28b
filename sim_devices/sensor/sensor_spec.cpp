// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/sensor_spec.h"

#include <fmt/format.h>

#include <type_traits>

#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/sensor_key.h"

namespace todbench {

std::string_view to_string(DisplayReconstruction reconstruction) {
  return reconstruction == DisplayReconstruction::bilinear ? "bilinear" : "sample_and_hold";
}

namespace {

std::string out_of_range(const SensorSpec& spec, const SensorKey& key) {
  const double value = std::visit(
      [&](auto member) -> double {
        if constexpr (std::is_same_v<decltype(member), DisplayReconstruction SensorSpec::*>)
          return 0;
        else
          return spec.*member;
      },
      key.member);
  return key.range.contains(value) ? "" : std::string(key.name) + " must be " + key.range.describe();
}

/// Reason why a sensor is impossible, as a sentence; empty for a possible sensor.
std::string impossible(const SensorSpec& spec) {
  if (spec.name.empty()) return "name is missing";
  for (const SensorKey& key : sensor_keys()) {
    if (std::string problem = out_of_range(spec, key); !problem.empty()) return problem;
  }
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.impossible == nullptr) continue;
    if (std::string problem = row.impossible(spec); !problem.empty()) return problem;
  }
  return "";
}

}  // namespace

Result<void> validate(const SensorSpec& spec) {
  const std::string problem = impossible(spec);
  if (problem.empty()) return {};
  return fail(ErrorCode::invalid_input,
              "sensor " + (spec.name.empty() ? std::string("without a name") : spec.name) + ": " + problem);
}

Result<void> require_square_pixels(const SensorSpec& spec, std::string_view task) {
  if (spec.pitch_aspect() == 1) return {};
  return fail(ErrorCode::invalid_input,
              "sensor " + spec.name + " has another pitch along y (pitch_y_um) than along x: " + std::string(task) +
                  " needs square pixels");
}

Result<void> check_picture_memory(const SensorSpec& spec, double memory_bytes) {
  constexpr double bytes_per_sample = 40;  // double, float, counts, and the mean, lowest and highest of an average
  constexpr double gib = 1 << 30;
  const int n = spec.samples_per_pitch();
  const double needed = bytes_per_sample * n * n * spec.width * spec.height;
  if (needed <= memory_bytes) return {};
  return fail(
      ErrorCode::invalid_input,
      fmt::format("sensor {}: pictures of {} x {} samples need about {:.3g} GiB of memory, and this machine has "
                  "{:.3g} GiB; choose a smaller width and height, or fewer samples per pitch",
                  spec.name, spec.width * n, spec.height * n, needed / gib, memory_bytes / gib));
}

}  // namespace todbench
