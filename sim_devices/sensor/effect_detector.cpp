// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_detector.h"

#include <algorithm>
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

double detector_mtf(double u_per_pitch, double w_per_pitch, double pitch_ratio_x, double pitch_ratio_y) {
  return sinc(u_per_pitch * pitch_ratio_x) * sinc(w_per_pitch * pitch_ratio_y);
}

EffectRow effect_rows::detector() {
  EffectRow row;
  row.title = "Detector footprint";
  row.keys = {{"detector_um", &SensorSpec::detector_um, NumberRange::between(0.1, 1000), KeyPresence::required,
               "sensitive side of a detector"},
              {"detector_y_um", &SensorSpec::detector_y_um, NumberRange::between(0, 1000), KeyPresence::optional,
               "sensitive side along the columns, if it differs; 0: detector_um"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    constexpr double most_unlike = 2;  // beyond it templates and lattices are not tested
    const double aspect = spec.pitch_aspect();
    if (!(aspect <= most_unlike && aspect * most_unlike >= 1))
      return "pitch_y_um is more than twice pitch_um, or less than half of it";
    if (spec.detector_um > spec.pitch_um) return "detector_um is larger than pitch_um: detectors cannot overlap";
    if (spec.detector_pitch_ratio(PitchAxis::y) > 1) {
      return spec.detector_y_um > 0 ? "detector_y_um is larger than the pitch along y: detectors cannot overlap"
                                    : "detector_um is larger than pitch_y_um: state detector_y_um";
    }
    return spec.detector_y_um > 0 && spec.detector_y_um < 0.1 ? "detector_y_um must be 0, or 0.1 to 1000" : "";
  };
  row.stage = stage::Footprint{
      [](double f, const SensorSpec& spec, PitchAxis axis) { return sinc(f * spec.detector_pitch_ratio(axis)); }};
  row.spread = [](const ChainScope& scope) {
    const SensorSpec& spec = scope.spec;
    const double side = std::max(spec.detector_pitch_ratio(PitchAxis::x), spec.detector_pitch_ratio(PitchAxis::y));
    return Spread{.period = 0, .window = 0, .variance = side * side / 12};
  };
  row.always = "always simulated: without the footprint, aliasing can raise or lower the acuity";
  return row;
}

}  // namespace todbench
