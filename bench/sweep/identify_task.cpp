// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/identify_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "acquisition/base/number_range.h"
#include "acquisition/base/try.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/resources.h"
#include "bench/studies/pictured_scenes.h"
#include "bench/text/files.h"
#include "bench/text/spread_text.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::array<std::string_view, 9> identification_keys{
    "set", "ranges_m", "atmosphere", "haze", "extinction_per_km", "cn2_m_minus_2_3", "decisions", "cues", "m75"};

/// ValueOfKey of the identification by key.
using ValueOfKey = std::map<std::string, std::string, std::less<>>;

ValueOfKey values_of(const std::vector<SweepParameter>& parameters) {
  ValueOfKey values;
  for (const auto& parameter : parameters) {
    if (is_identification_key(parameter.key)) values[parameter.key] = parameter.value;
  }
  return values;
}

Result<double> number_in_values(const ValueOfKey& values, std::string_view key, const NumberRange& range,
                                double fallback) {
  const auto found = values.find(key);
  if (found == values.end()) return fallback;
  const auto number = parse_number(found->second);
  if (number && range.contains(*number)) return *number;
  return fail_at(ErrorCode::invalid_input, std::string(key),
                 "expected " + range.describe() + ", found '" + one_line(found->second) + "'");
}

std::string word_in(const ValueOfKey& values, std::string_view key, std::string_view fallback) {
  const auto found = values.find(key);
  return found == values.end() ? std::string(fallback) : found->second;
}

/// Numbers between commas, with or without brackets.
Result<std::vector<double>> ranges_in(const ValueOfKey& values) {
  std::string text = word_in(values, "ranges_m", "");
  std::erase_if(text, [](char c) { return c == '[' || c == ']' || c == ' '; });
  std::vector<double> ranges;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto number = parse_number(text.substr(begin, end - begin));
    if (!number)
      return fail_at(ErrorCode::invalid_input, "ranges_m", "expected numbers in m, found '" + one_line(text) + "'");
    ranges.push_back(*number);
    begin = end + 1;
  }
  if (ranges.size() < 2) return fail_at(ErrorCode::invalid_input, "ranges_m", "expected at least two ranges in m");
  return ranges;
}

/// An air by name is returned unchanged; a file has a slash or a dot.
std::string air_reference(const ValueOfKey& values, const std::filesystem::path& folder) {
  const std::string air = word_in(values, "atmosphere", "clear");
  return air.find_first_of("/.") == std::string::npos ? air : (folder / air).string();
}

std::string set_reference(const ValueOfKey& values, const std::filesystem::path& folder) {
  return absolute_reference(word_in(values, "set", "small-craft"), folder);
}

std::string text_of_view(const FieldScene& scene) {
  std::string text = fmt::format("{} {} {}\n", scene.background_k, scene.background_emissivity, scene.surround_k);
  for (const auto& region : scene.regions) {
    text += fmt::format("{} {} {}:", region.temperature_k, region.emissivity, region.target);
    for (const auto& v : region.outline_m) text += fmt::format(" {} {}", v.x, v.y);
    text += "\n";
  }
  if (!scene.picture) return text;
  text += fmt::format("{} {}\n", scene.picture->element_m, scene.picture->kelvin.cols);
  for (int i = 0; i < static_cast<int>(scene.picture->kelvin.total()); ++i)
    text +=
        fmt::format("{} {}\n", scene.picture->kelvin(i / scene.picture->kelvin.cols, i % scene.picture->kelvin.cols),
                    scene.picture->target(i / scene.picture->kelvin.cols, i % scene.picture->kelvin.cols));
  return text;
}

}  // namespace

bool is_identification_key(std::string_view key) {
  return std::ranges::find(identification_keys, key) != identification_keys.end();
}

Result<IdentificationStudyTask> identification_task(const std::vector<SweepParameter>& parameters,
                                                    const std::filesystem::path& folder, const LoadedPlan& plan,
                                                    std::stop_token stop) {
  const ValueOfKey values = values_of(parameters);
  IdentificationStudyTask task;
  task.sensor = plan.sensor();
  task.observer = plan.observer();
  TODBENCH_TRY(task.accuracy, Accuracy::named(plan.plan().simulation.accuracy));
  task.motion = plan.plan().simulation.motion;
  task.seed = plan.plan().seed;
  task.stop = std::move(stop);
  TODBENCH_TRY(task.ranges_m, ranges_in(values));
  TODBENCH_TRY(const double decisions, number_in_values(values, "decisions", NumberRange::between(16, 1e6), 2000));
  task.decisions = static_cast<int>(std::lround(decisions));
  TODBENCH_TRY(task.m75, number_in_values(values, "m75", NumberRange::between(1e-6, 1e6), task.m75));
  TODBENCH_TRY(task.cn2_m_minus_2_3, number_in_values(values, "cn2_m_minus_2_3", NumberRange::between(0, 1e-11), 0));
  if (values.contains("cn2_m_minus_2_3")) task.sensor.turbulence_cn2_m_minus_2_3 = 0;  // that of the paths replaces it
  const std::string cues = word_in(values, "cues", "all");
  if (cues != "all" && cues != "shape") return fail_at(ErrorCode::invalid_input, "cues", "expected all or shape");
  task.cues = cues == "shape" ? TargetCues::shape : TargetCues::all;
  TODBENCH_TRY(task.set, target_set_with_pictures(set_reference(values, folder)));
  TODBENCH_TRY(const double extinction, number_in_values(values, "extinction_per_km", NumberRange::between(0, 1e4), 0));
  const std::string air = air_reference(values, folder);
  TODBENCH_TRY(task.air, load_atmosphere(extinction > 0 && air == "clear" ? "beer-lambert" : air,
                                         {.band = {task.sensor.wavelength_min_um, task.sensor.wavelength_max_um},
                                          .haze = word_in(values, "haze", "rural-23km"),
                                          .weight_temperature_k = task.sensor.scene_temperature_k,
                                          .extinction_per_km = extinction}));
  return task;
}

Result<std::string> identification_fingerprint(const std::vector<SweepParameter>& parameters,
                                               const std::filesystem::path& folder) {
  const ValueOfKey values = values_of(parameters);
  TODBENCH_TRY(const auto set, target_set_with_pictures(set_reference(values, folder)));
  std::string text;
  for (const auto& target : set.targets) {
    text += target.name + "\n";
    for (const auto& aspect : target.aspects) text += text_of_view(aspect);
  }
  if (const std::string air = air_reference(values, folder); air.find_first_of("/.") != std::string::npos) {
    TODBENCH_TRY(const auto content, read_text_file(air));
    text += content;
  }
  return "identification " + sha256_of(text) + "\n";
}

Result<Json> identified(const IdentificationStudyTask& task) {
  TODBENCH_TRY(const auto study, study_identification(task));
  Json row{{"r75_m", json_number(study.r75_m.value)},
           {"r75_ci95_m", json_interval(study.r75_m.ci95)},
           {"m75_of_set", json_number(study.m75.value)},
           {"m75_of_set_ci95", json_interval(study.m75.ci95)},
           {"v50_of_set", json_number(study.v50.value)},
           {"v50_of_set_ci95", json_interval(study.v50.ci95)},
           {"size_m", json_number(study.size_m)},
           {"dt_rss_k", json_number(study.dt_rss_k)},
           {"predicted_r75_m", json_number(study.predicted ? study.predicted->r75_m : std::nullopt)},
           {"no_m75_because", study.no_m75_because}};
  add_spread(row, "r75_spread_m", study.r75_m.spread);
  return Json{{"points", Json::array({std::move(row)})}};
}

}  // namespace todbench
