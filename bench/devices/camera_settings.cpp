// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/camera_settings.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include "acquisition/base/safe_text.h"
#include "acquisition/core/control_text.h"

namespace todbench {
namespace {

std::optional<bool> switch_of(const std::string& text) {
  if (text == "1" || text == "true" || text == "on") return true;
  if (text == "0" || text == "false" || text == "off") return false;
  return std::nullopt;
}

/// Features that vary between readings, belong to the connection, or set the correction mode, which the run controls.
bool may_change(std::string_view feature) {
  constexpr std::array names{"DeviceTemperature", "SensorTemperature", "HousingTemperature", "SocketBufferBytes",
                             "DeadPixels"};
  return std::ranges::find(names, feature) != names.end() || lower_case(feature).find("nuc") != std::string::npos;
}

}  // namespace

bool scales_counts(std::string_view feature) {
  // Planck constants of radiometric cameras have names of one or two letters.
  constexpr std::array constants{"R", "B", "F", "O", "J0", "J1"};
  if (std::ranges::find(constants, feature) != constants.end()) return true;
  constexpr std::array words{"gain",      "range",        "currentcase", "scale",       "temperaturelinear",
                             "irformat",  "tlinear",      "exposure",    "integration", "emissivity",
                             "reflected", "transmission", "atmos",       "humidity",    "objectdist",
                             "extoptics", "windowtemp",   "radiometr",   "offset_k",    "kelvin"};
  const std::string name = lower_case(feature);
  return std::ranges::any_of(words, [&](const char* word) { return name.find(word) != std::string::npos; });
}

bool same_setting(std::string_view written, std::string_view read) {
  const std::string a = lower_case(written), b = lower_case(read);
  if (a == b) return true;
  if (const auto one = switch_of(a), other = switch_of(b); one && other) return *one == *other;
  const auto one = control_number(a), other = control_number(b);
  constexpr double rounding = 1e-3;
  return one && other && std::abs(*one - *other) <= rounding * std::abs(*one);
}

Result<std::vector<std::string>> check_written_settings(FrameSource& camera,
                                                        const std::map<std::string, std::string>& written) {
  std::vector<std::string> warnings;
  for (const auto& [feature, value] : written) {
    const auto read = camera.get(feature);
    if (!read && read.error().code == ErrorCode::disconnected) return tl::unexpected(read.error());
    if (!read || same_setting(value, *read)) continue;
    const std::string sentence = feature + " was set to " + value + " and reads back as " + *read;
    if (scales_counts(feature))
      return fail(ErrorCode::calibration, sentence + ": the temperature scale of the counts is unknown");
    warnings.push_back(sentence + ".");
  }
  return warnings;
}

std::vector<ChangedSetting> changed_settings(FrameSource& camera, const SourceInfo& at_start) {
  std::vector<ChangedSetting> out;
  for (const auto& [feature, before] : at_start.settings) {
    if (may_change(feature)) continue;
    const auto now = camera.get(feature);
    if (!now && now.error().code == ErrorCode::disconnected) return {};
    if (now && !same_setting(before, *now)) out.push_back({feature, before, *now});
  }
  return out;
}

std::string sentence(const ChangedSetting& changed) {
  return changed.feature + " was " + changed.before + " at the start and is " + changed.now + " at the end";
}

}  // namespace todbench
