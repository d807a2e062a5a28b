// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_detector.h"

#include <cmath>
#include <numbers>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

double sinc(double x) {
  const double y = std::numbers::pi * x;
  return std::abs(y) < 1e-8 ? 1.0 : std::sin(y) / y;
}

}  // namespace

double detector_mtf(double u_per_pitch, double w_per_pitch, double detector_pitch_ratio) {
  return sinc(u_per_pitch * detector_pitch_ratio) * sinc(w_per_pitch * detector_pitch_ratio);
}

EffectRow effect_rows::detector() {
  EffectRow row;
  row.title = "Detector footprint";
  row.keys = {{"detector_um", &SensorSpec::detector_um, NumberRange::between(0.1, 1000), KeyPresence::required,
               "sensitive side of a detector"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    return spec.detector_um > spec.pitch_um ? "detector_um is larger than pitch_um: detectors cannot overlap" : "";
  };
  row.stage = stage::Footprint{[](double f, const SensorSpec& spec) { return sinc(f * spec.detector_pitch_ratio()); }};
  row.spread = [](const ChainScope& scope) {
    const double side = scope.spec.detector_pitch_ratio();
    return Spread{.period = 0, .window = 0, .variance = side * side / 12};
  };
  row.always = "always simulated: without the footprint, aliasing can raise or lower the acuity";
  return row;
}

}  // namespace todbench
