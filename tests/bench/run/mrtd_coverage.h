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

/// virtual_mrtd() of the SC2000 with `draws`.
inline Result<std::vector<VirtualMrtdPoint>> true_mrtd(const std::vector<double>& per_pitch, int draws,
                                                       const TemplateObserverSpec& observer) {
  VirtualMrtdTask task;
  task.sensor = *load_sensor("sc2000"), task.plan = full_plan(task.sensor, {}, {});
  task.accuracy = Accuracy::draft(), task.draws = draws, task.observer = observer;
  for (const double f : per_pitch) task.frequencies_per_mrad.push_back(f / task.sensor.ifov_mrad());
  return virtual_mrtd(task);
}

/// Frames of the SC2000 at 2 m with white noise of its NETD, judged as in a session: eight set-ups of 16 frames at
/// eight contrasts. The plate is 0.3 and -0.2 pixels from where the judge is told: a plate is located to a whole pixel.
class MrtdRuns {
 public:
  /// `offset_k`: of the target.
  MrtdRuns(const std::vector<double>& per_pitch, double offset_k, const TemplateObserverSpec& observer)
      : offset_k_(offset_k) {
    const SensorModel model(sensor_, full_plan(sensor_, {}, {}), Accuracy::draft(), 1);
    options_.plate = *load_plate("mrtd");
    options_.observer = observer;
    constexpr double pixel_mm = 2.617;
    std::erase_if(options_.plate.bars, [&](const PlateBars& group) {
      return std::ranges::none_of(per_pitch,
                                  [&](double f) { return std::abs(pixel_mm / (2 * group.bar_mm) - f) < 0.01; });
    });
    std::erase_if(options_.plate.rectangles, [](const PlateRectangle& one) { return one.name.starts_with("spot"); });
    const double scale = 1 / (2 * sensor_.ifov_mrad());
    where_.plate_to_pixel = {scale, 0, 159.5, 0, scale, 119.5, 0, 0, 1};
    where_.scale_px_per_mm = scale;
    presentations_ = mrtd_presentations(options_, 1 / scale);
    for (const MrtdPresentation& one : presentations_) {
      if (one.set_up < 0 || unit_.count(one.set_up) > 0) continue;
      PlateScene scene;
      scene.plate = options_.plate;
      scene.shift_mm = one.state.shift_mm;
      model.unit_signal(scene)->convertTo(unit_[one.set_up], CV_32F);
    }
  }

  [[nodiscard]] Result<std::vector<MrtdPoint>> bars(std::uint64_t seed) const {
    MrtdOptions options = options_;
    options.seed = seed;
    auto judge = BarsJudge::create(options, where_);
    if (!judge) return tl::unexpected(judge.error());
    const RandomStream noise(seed, "mrtd coverage");
    std::uint64_t frame = 0;
    for (const MrtdPresentation& one : presentations_) {
      for (int k = 0; one.set_up >= 0 && k < options.frames; ++k) {
        cv::Mat1f picture(240, 320);
        noise.sub(frame++).fill_normal({picture.ptr<float>(), picture.total()});
        const double shown_k = one.state.delta_t_k + offset_k_;
        cv::Mat1d kelvin;
        cv::Mat1f(sensor_.netd_k * picture + shown_k * unit_.at(one.set_up)).convertTo(kelvin, CV_64F);
        judge->add(kelvin, {one.set_up, one.level, one.state.delta_t_k, Mounting::identity,
                            where_.shifted(one.state.shift_mm), sensor_.netd_k});
      }
    }
    return judge->result().bars;
  }

 private:
  SensorSpec sensor_ = *load_sensor("sc2000");
  double offset_k_;
  MrtdOptions options_;
  Registration where_;
  std::vector<MrtdPresentation> presentations_;
  std::map<int, cv::Mat1f> unit_;
};

/// The intervals of MrtdRuns against true_mrtd() of `draws`.
inline Result<std::vector<MrtdCoverage>> mrtd_coverage(std::vector<double> per_pitch, int seeds, int draws,
                                                       double offset_k = 0, const TemplateObserverSpec& observer = {}) {
  const auto truth = true_mrtd(per_pitch, draws, observer);
  if (!truth) return tl::unexpected(truth.error());
  const MrtdRuns runs(per_pitch, offset_k, observer);
  std::vector<MrtdCoverage> out;
  for (std::size_t k = 0; k < per_pitch.size(); ++k) {
    const VirtualMrtdPoint& known = (*truth)[k];
    out.push_back({per_pitch[k], known.threshold_k.value_or(0), known.relative_error, known.best_phase_k.value_or(0)});
  }
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto bars = runs.bars(static_cast<std::uint64_t>(seed));
    if (!bars) return tl::unexpected(bars.error());
    for (const MrtdPoint& point : *bars) {
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
