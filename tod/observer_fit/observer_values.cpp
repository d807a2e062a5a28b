// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/observer_fit/observer_values.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr std::size_t blur = 0, internal = 1, factor = 2;

}  // namespace

std::string_view to_string(ObserverKey key) {
  switch (key) {
    case ObserverKey::blur_sigma_samples:
      return "blur_sigma_samples";
    case ObserverKey::internal_noise:
      return "internal_noise";
    case ObserverKey::sensor_noise_factor:
      return "sensor_noise_factor";
    case ObserverKey::lapse:
      return "lapse";
  }
  return "";
}

std::string_view parameter_name(ObserverKey key, FittedKind kind) {
  if (kind == FittedKind::eye && key == ObserverKey::blur_sigma_samples) return "gain";
  if (kind == FittedKind::eye && key == ObserverKey::internal_noise) return "contrast_noise";
  return to_string(key);
}

ObserverPlace place_of(const ObserverValues& values, FittedKind kind) {
  const ObserverValues least = observer_limits(kind).least;
  ObserverPlace place = values;
  for (const std::size_t k : {blur, internal, factor}) place[k] = std::log(std::max(values[k], least[k]));
  return place;
}

ObserverValues values_at(const ObserverPlace& place) {
  ObserverValues values = place;
  for (const std::size_t k : {blur, internal, factor}) values[k] = std::exp(place[k]);
  return values;
}

}  // namespace todbench
