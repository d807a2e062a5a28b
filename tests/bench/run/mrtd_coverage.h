// SPDX-License-Identifier: GPL-3.0-or-later
// How often the MRTD of the shipped plate holds that of the sensor without frames: for the test and the study.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "acquisition/base/rng.h"
#include "bench/plan/descriptions.h"
#include "sim_devices/prediction/virtual_mrtd.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/camera_measures/bars_judge.h"

namespace todbench::testing {

/// Of one frequency, over seeds and axes: shares of intervals that hold the truth, mean of ln found over true.
struct MrtdCoverage {
  double frequency_per_pitch = 0, truth_k = 0, truth_error = 0, best_k = 0;
  int intervals = 0;
  double within = 0, bias = 0, half_width = 0, best_within = 0, best_bias = 0;
  int spreads = 0;                        ///< thresholds with a spread over the open parameters of the observer
  double lower_bias = 0, upper_bias = 0;  ///< mean of ln found over true of its ends
};

/// Frames of the SC2000 at 2 m with white noise of its NETD, judged as in a session: eight set-ups of 16 frames at
/// eight contrasts. `offset_k`: of the target. The plate is 0.3 and -0.2 pixels from where the judge is told: a plate
/// is located to a whole pixel. The truth is virtual_mrtd() of `draws`.
inline Result<std::vector<MrtdCoverage>> mrtd_coverage(std::vector<double> per_pitch, int seeds, int draws,
                                                       double offset_k = 0, const TemplateObserverSpec& observer = {}) {
  const SensorSpec sensor = *load_sensor("sc2000");
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  VirtualMrtdTask task;
  task.sensor = sensor, task.plan = model.plan(), task.accuracy = Accuracy::draft(), task.draws = draws;
  task.observer = observer;
  for (const double f : per_pitch) task.frequencies_per_mrad.push_back(f / sensor.ifov_mrad());
  const auto truth = virtual_mrtd(task);
  if (!truth) return tl::unexpected(truth.error());
  MrtdOptions options;
  options.plate = *load_plate("mrtd");
  options.observer = observer;
  constexpr double pixel_mm = 2.617;
  std::erase_if(options.plate.bars, [&](const PlateBars& group) {
    return std::ranges::none_of(per_pitch,
                                [&](double f) { return std::abs(pixel_mm / (2 * group.bar_mm) - f) < 0.01; });
  });
  std::erase_if(options.plate.rectangles, [](const PlateRectangle& one) { return one.name.starts_with("spot"); });
  const double scale = 1 / (2 * sensor.ifov_mrad());
  Registration where;
  where.plate_to_pixel = {scale, 0, 159.5, 0, scale, 119.5, 0, 0, 1};
  where.scale_px_per_mm = scale;
  const auto presentations = mrtd_presentations(options, 1 / scale);
  std::map<int, cv::Mat1f> unit;
  for (const MrtdPresentation& one : presentations) {
    if (one.set_up < 0 || unit.count(one.set_up) > 0) continue;
    PlateScene scene;
    scene.plate = options.plate;
    scene.shift_mm = one.state.shift_mm;
    model.unit_signal(scene)->convertTo(unit[one.set_up], CV_32F);
  }
  std::vector<MrtdCoverage> out;
  for (std::size_t k = 0; k < per_pitch.size(); ++k) {
    const VirtualMrtdPoint& known = (*truth)[k];
    out.push_back({per_pitch[k], known.threshold_k.value_or(0), known.relative_error, known.best_phase_k.value_or(0)});
  }
  for (int seed = 1; seed <= seeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    auto judge = BarsJudge::create(options, where);
    if (!judge) return tl::unexpected(judge.error());
    const RandomStream noise(options.seed, "mrtd coverage");
    std::uint64_t frame = 0;
    for (const MrtdPresentation& one : presentations) {
      for (int k = 0; one.set_up >= 0 && k < options.frames; ++k) {
        cv::Mat1f picture(240, 320);
        noise.sub(frame++).fill_normal({picture.ptr<float>(), picture.total()});
        const double shown_k = one.state.delta_t_k + offset_k;
        cv::Mat1d kelvin;
        cv::Mat1f(sensor.netd_k * picture + shown_k * unit[one.set_up]).convertTo(kelvin, CV_64F);
        judge->add(kelvin, {one.set_up, one.level, one.state.delta_t_k, Mounting::identity,
                            where.shifted(one.state.shift_mm), sensor.netd_k});
      }
    }
    for (const MrtdPoint& point : judge->result().bars) {
      for (MrtdCoverage& of : out) {
        if (std::abs(of.frequency_per_pitch - point.frequency_per_pitch) > 0.01) continue;
        ++of.intervals;
        if (!point.threshold_k || !point.ci95.low) continue;
        of.within += *point.ci95.low <= of.truth_k && of.truth_k <= *point.ci95.high ? 1 : 0;
        of.bias += std::log(*point.threshold_k / of.truth_k);
        of.half_width += 0.5 * std::log(*point.ci95.high / *point.ci95.low);
        if (const auto& known = (*truth)[static_cast<std::size_t>(&of - out.data())].spread_k;
            known && point.spread_k) {
          ++of.spreads;
          of.lower_bias += std::log(point.spread_k->first / known->first);
          of.upper_bias += std::log(point.spread_k->second / known->second);
        }
        if (!point.best_phase_k || !point.best_phase_ci95.low) continue;
        of.best_within += *point.best_phase_ci95.low <= of.best_k && of.best_k <= *point.best_phase_ci95.high ? 1 : 0;
        of.best_bias += std::log(*point.best_phase_k / of.best_k);
      }
    }
  }
  for (MrtdCoverage& of : out) {
    for (double* sum : {&of.within, &of.bias, &of.half_width, &of.best_within, &of.best_bias}) *sum /= of.intervals;
    for (double* sum : {&of.lower_bias, &of.upper_bias}) *sum /= std::max(1, of.spreads);
  }
  return out;
}

}  // namespace todbench::testing
