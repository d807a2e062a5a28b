// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/staged_scene.h"

#include <cmath>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/identification_passes.h"

namespace todbench {
Result<StagedFrame> behind_stages(const SensorModel& model,
                                  const std::function<std::vector<std::unique_ptr<ChainStage>>()>& stages,
                                  const std::vector<cv::Mat1f>& signals, double background_k, const cv::Rect& field) {
  const SensorSpec& spec = model.spec();
  const auto last_of = [&](const std::function<cv::Mat1f(std::size_t)>& signal) -> Result<cv::Mat1d> {
    const auto own = stages();
    cv::Mat1f picture;
    for (std::size_t k = 0; k < signals.size(); ++k) {
      const bool last = k + 1 == signals.size();
      model.expose(signal(k), 1, background_k, last ? 0 : k + 1).convertTo(picture, CV_32F);
      for (const auto& stage : own) {
        TODBENCH_TRY(picture, stage->process(picture));
      }
    }
    cv::Mat1d kelvin;
    picture.convertTo(kelvin, CV_64F, spec.kelvin_per_count);
    return kelvin;
  };
  TODBENCH_TRY(const auto moving, last_of([&](std::size_t k) { return signals[k]; }));
  TODBENCH_TRY(const auto still, last_of([&](std::size_t) { return signals.back(); }));
  TODBENCH_TRY(const auto empty, last_of([&](std::size_t) { return cv::Mat1f::zeros(model.size()); }));
  const cv::Mat1d in_front = without_mean(signals.back()(field));
  StagedFrame out;
  out.gain = without_mean(still(field) - empty(field)).dot(in_front) / in_front.dot(in_front);
  if (!std::isfinite(out.gain) || out.gain == 0)
    return fail(ErrorCode::not_identifiable, "behind the processing stages the scene has no contrast");
  moving.convertTo(out.kelvin, CV_32F, 1 / out.gain, -cv::mean(empty)[0] / out.gain);
  return out;
}

}  // namespace todbench
