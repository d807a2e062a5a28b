// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/open_parameters.h"

#include <algorithm>
#include <cmath>

namespace todbench {

std::optional<OpenParameterRange> open_parameter_range(const TemplateObserverSpec& spec) {
  if (!spec.eye) return std::nullopt;
  const double four_db = std::pow(10, 0.2);
  OpenParameterRange range{spec, spec};
  EyeParameters &best = *range.best.eye, &worst = *range.worst.eye;
  best.sensitivity *= four_db;
  worst.sensitivity /= four_db;
  best.uncertainty_channels = std::max(3000.0, spec.eye->uncertainty_channels);
  worst.uncertainty_channels = std::min(100.0, spec.eye->uncertainty_channels);
  best.contrast_noise = 0;
  worst.contrast_noise = std::max(0.07, spec.eye->contrast_noise);
  range.best.sensor_noise_factor = std::min(1.1, spec.sensor_noise_factor);
  range.worst.sensor_noise_factor = std::max(3.2, spec.sensor_noise_factor);
  return range;
}

std::vector<TemplateObserverSpec> open_ends(const TemplateObserverSpec& spec) {
  const auto range = open_parameter_range(spec);
  return range ? std::vector{range->best, range->worst} : std::vector<TemplateObserverSpec>();
}

std::optional<std::pair<double, double>> spread_of(std::initializer_list<std::optional<double>> values) {
  std::optional<std::pair<double, double>> spread;
  for (const std::optional<double>& value : values) {
    if (!value) return std::nullopt;
    if (!spread) spread.emplace(*value, *value);
    spread = std::pair(std::min(spread->first, *value), std::max(spread->second, *value));
  }
  return spread;
}

}  // namespace todbench
