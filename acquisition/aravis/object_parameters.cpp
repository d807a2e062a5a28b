// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/object_parameters.h"

#include <array>
#include <cmath>
#include <optional>

#include "acquisition/core/control_text.h"

namespace todbench {
namespace {

constexpr std::array all_parameters{"ObjectEmissivity",
                                    "Emissivity",
                                    "ObjectDistance",
                                    "RelativeHumidity",
                                    "ReflectedTemperature",
                                    "BackgroundTemperature",
                                    "Transmission",
                                    "EstimatedTransmission",
                                    "AtmosphericTransmission",
                                    "AtmosphericTemperature",
                                    "AmbientTemperature",
                                    "WindowTransmission",
                                    "WindowTemperature",
                                    "WindowReflection",
                                    "WindowReflectedTemperature",
                                    "ExtOpticsTransmission",
                                    "ExtOpticsTemperature",
                                    "TransmittedTemperature"};

/// A parameter and its neutral value.
struct Neutral {
  const char* feature;
  double value;
};
constexpr std::array neutral_values{Neutral{"ObjectEmissivity", 1},   Neutral{"Emissivity", 1},
                                    Neutral{"Transmission", 1},       Neutral{"AtmosphericTransmission", 1},
                                    Neutral{"WindowTransmission", 1}, Neutral{"ExtOpticsTransmission", 1},
                                    Neutral{"WindowReflection", 0}};
/// Cameras store factors in steps of 1/8192 or 0.001.
constexpr double factor_step = 1e-3;

std::optional<double> number_of(const std::map<std::string, std::string>& settings, const char* feature) {
  const auto found = settings.find(feature);
  return found == settings.end() ? std::nullopt : control_number(found->second);
}

}  // namespace

std::span<const char* const> object_parameters() {
  return all_parameters;
}

std::vector<std::string> object_parameter_notes(const std::map<std::string, std::string>& settings) {
  std::string not_neutral;
  const auto add = [&](const char* feature) {
    not_neutral += (not_neutral.empty() ? "" : ", ") + std::string(feature) + " = " + settings.at(feature);
  };
  for (const auto& [feature, neutral] : neutral_values) {
    if (!settings.contains(feature)) continue;
    const auto value = number_of(settings, feature);
    if (!value || std::abs(*value - neutral) > factor_step) add(feature);
  }
  // If the transmission of the atmosphere is not stated (0), it follows from the distance.
  const auto stated = number_of(settings, "EstimatedTransmission");
  if (stated && *stated > 0) {
    if (std::abs(*stated - 1) > factor_step) add("EstimatedTransmission");
  } else if (const auto distance = number_of(settings, "ObjectDistance"); distance && *distance > 0) {
    add("ObjectDistance");
  }
  if (not_neutral.empty()) return {};
  return {"The camera computes its temperatures with " + not_neutral + ". These are not black-body temperatures."};
}

}  // namespace todbench
