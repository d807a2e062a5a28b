// SPDX-License-Identifier: GPL-3.0-or-later
// TOD and four bars on the same simulated imagers, judged by the same observer: points of the transfer between both.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/prediction/virtual_mrtd.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/plate/test_pattern.h"
#include "tod/range/bars_sampled.h"
#include "tod/range/log_linear_curve.h"

namespace todbench::testing {

inline SensorSpec imager(std::string name, double pitch_um, double detector_um, double f_number, double blur_pitch,
                         double netd_k) {
  SensorSpec spec;
  spec.name = std::move(name);
  spec.pitch_um = pitch_um;
  spec.detector_um = detector_um;
  spec.f_number = f_number;
  spec.aberration_sigma_pitch = blur_pitch;
  spec.netd_k = netd_k;
  return spec;
}

/// An imager for 3.7 to 4.8 um.
inline SensorSpec midwave(SensorSpec spec) {
  spec.wavelength_min_um = 3.7;
  spec.wavelength_max_um = 4.8;
  return spec;
}

/// Ten imagers with a transfer at Nyquist of 10 to 73 %.
inline std::vector<SensorSpec> studied_imagers() {
  return {imager("LWIR 47.5 um f/1, fill 0.40", 47.5, 30, 1, 0, 0.07),
          imager("LWIR 47.5 um f/1 (SC2000)", 47.5, 42.5, 1, 0, 0.07),
          imager("LWIR 25 um f/1", 25, 23, 1, 0, 0.05),
          imager("LWIR 17 um f/1", 17, 15.5, 1, 0.1, 0.05),
          midwave(imager("MWIR 15 um f/2", 15, 13.5, 2, 0.1, 0.025)),
          imager("LWIR 17 um f/1.2, blur 0.3", 17, 15.5, 1.2, 0.3, 0.04),
          imager("LWIR 12 um f/1", 12, 10.8, 1, 0.3, 0.05),
          midwave(imager("MWIR 15 um f/4", 15, 13.5, 4, 0.2, 0.02)),
          imager("LWIR 12 um f/1.2, blur 0.4", 12, 10.8, 1.2, 0.4, 0.06),
          midwave(imager("MWIR 10 um f/3, blur 0.3", 10, 9, 3, 0.3, 0.025))};
}

/// Camera of the filters: a cooled, under-sampled imager, with six edge filters. The last two also blur behind the
/// filter, as a Wiener filter does: they boost medium frequencies and reduce the highest.
inline std::vector<SensorSpec> filtered_imagers() {
  std::vector<SensorSpec> found;
  const SensorSpec plain = midwave(imager("MWIR 15 um f/2", 15, 13.5, 2, 0.1, 0.025));
  for (const auto& [boost, blur] : {std::pair(0.05, 0.0), std::pair(0.1, 0.0), std::pair(0.2, 0.0), std::pair(0.4, 0.0),
                                    std::pair(0.5, 0.3), std::pair(1.0, 0.45)}) {
    SensorSpec spec = plain;
    spec.edge_boost = boost;
    spec.display_blur_samples = blur;
    spec.name = "MWIR 15 um f/2, boost " + std::to_string(boost).substr(0, 4) +
                (blur > 0 ? ", blur " + std::to_string(blur).substr(0, 4) : "");
    found.push_back(spec);
  }
  return found;
}

/// Transfer of optics and detector along x, at half a cycle per detector pitch.
inline double transfer_at_nyquist(const SensorSpec& sensor) {
  return sensor_transfer(sensor, full_plan(sensor, {}, {}), 16)(0.5, 0).real();
}

struct MethodDesign {
  Accuracy accuracy = Accuracy::normal();
  int bar_draws = 500;
  std::uint64_t seed = 1;
  std::vector<double> over_netd{1.2, 2, 4, 8, 20, 60, 200};  ///< contrasts
  std::vector<double> of_nyquist{0.1, 0.14, 0.2, 0.28, 0.36, 0.44, 0.52, 0.6, 0.7, 0.8,
                                 0.9, 1.0,  1.1, 1.2,  1.3,  1.4,  1.5,  1.6, 1.7};
};

/// Both methods at one contrast of one imager.
struct MethodPoint {
  std::string imager;
  double over_netd = 0;
  double acuity_over_nyquist = 0;  ///< 1 / S75 over the Nyquist frequency of the displayed samples
  double acuity_share = 0;         ///< 1 / S75 over that at the highest contrast
  double acuity_error = 0;         ///< relative standard error
  double bars_over_nyquist = 0;    ///< highest frequency with a threshold up to this contrast
  bool at_end = false;             ///< bars: the contrast is above the highest threshold
  [[nodiscard]] double factor() const { return bars_over_nyquist / acuity_over_nyquist; }
};

/// Highest frequency over Nyquist, in steps of 0.002, up to which the displayed samples separate at least two bars at
/// the best phase.
inline double end_of_bars(const SensorSpec& sensor) {
  const int n = sensor.samples_per_pitch();
  const TransferFunction camera = sensor_transfer(sensor, full_plan(sensor, {}, {}), 16);
  const std::vector<double> taps = taps_of([&](double f) { return display_response(sensor, f); });
  const auto separated = [&](double of_nyquist) {
    const double frequency = of_nyquist / 2;
    const BlurredBars bars(
        frequency, [&](double u) { return camera(u * n, 0).real(); }, 4.0 / n);
    const auto shown = [&](double x) {
      double sum = 0;
      for (std::size_t k = 0; k < taps.size(); ++k)
        sum += taps[k] * bars.at(x - (static_cast<double>(k) - static_cast<double>(taps.size() / 2)));
      return sum;
    };
    return (has_display(sensor) ? bar_modulation(shown, frequency, 16) : bar_modulation(bars, 16))
               .bars_separated_at_best >= 2;
  };
  double end = 0.5;
  for (const double step : {0.05, 0.01, 0.002})
    while (end + step < 1.745 && separated(end + step)) end += step;
  return end;
}

/// Thresholds of four bars at the best phase over frequency / Nyquist, up to end_of_bars().
inline LogLinearCurve bar_curve(const SensorSpec& sensor, const TemplateObserverSpec& observer,
                                const MethodDesign& design) {
  const double nyquist_per_mrad = 0.5 * sensor.samples_per_pitch() / sensor.ifov_mrad(), end = end_of_bars(sensor);
  VirtualMrtdTask task{.sensor = sensor,
                       .plan = full_plan(sensor, {}, {}),
                       .observer = observer,
                       .accuracy = design.accuracy,
                       .frequencies_per_mrad = {},
                       .draws = design.bar_draws,
                       .seed = design.seed};
  for (const double f : design.of_nyquist)
    if (f < end - 0.02) task.frequencies_per_mrad.push_back(f * nyquist_per_mrad);
  task.frequencies_per_mrad.push_back(end * nyquist_per_mrad);
  const auto found = virtual_mrtd(task);
  EXPECT_TRUE(found) << sensor.name << ": " << found.error().message;
  std::vector<CurvePoint> points;
  for (const VirtualMrtdPoint& point : found.value())
    if (point.best_phase_k) points.push_back({point.frequency_over_nyquist, *point.best_phase_k});
  return LogLinearCurve::of(points, "bars").value();
}

/// Contrasts outside the bars' curve or without a TOD threshold are left out.
inline std::vector<MethodPoint> method_points(const SensorSpec& sensor, const TemplateObserverSpec& observer,
                                              const MethodDesign& design) {
  const LogLinearCurve bars = bar_curve(sensor, observer, design);
  TemplateObserver judge(observer, triangle_alternatives());
  std::vector<MethodPoint> points;
  for (const double over_netd : design.over_netd) {
    const double delta_t_k = over_netd * sensor.netd_k;
    const auto frequency = bars.highest_frequency_at(delta_t_k);
    const auto tod = direct_estimate(sensor, full_plan(sensor, {}, {}), judge, {delta_t_k},
                                     {.accuracy = design.accuracy, .seed = design.seed});
    if (!frequency || !tod) continue;
    const DirectPoint& point = tod->front();
    points.push_back({.imager = sensor.name,
                      .over_netd = over_netd,
                      .acuity_over_nyquist = 2 / (point.s75_pitch * sensor.samples_per_pitch()),
                      .acuity_share = 0,
                      .acuity_error = point.standard_error_pitch / point.s75_pitch,
                      .bars_over_nyquist = *frequency,
                      .at_end = *frequency >= bars.points().back().frequency});
  }
  for (MethodPoint& point : points) point.acuity_share = point.acuity_over_nyquist / points.back().acuity_over_nyquist;
  return points;
}

}  // namespace todbench::testing
