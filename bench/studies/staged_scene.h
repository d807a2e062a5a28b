// SPDX-License-Identifier: GPL-3.0-or-later
// Frame of a scene after processing stages, in units of the contrast of the scene before the stages.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/module/picture_stage.h"
#include "sim_devices/sensor/sensor_model.h"

namespace todbench {

/// Frame after the stages.
struct StagedFrame {
  cv::Mat1f kelvin;  ///< signal above the mean of the frame without a scene, divided by the gain
  double gain = 1;   ///< gain of the contrast of a scene at rest, by least squares over `field`
};

/// Passes the counts of successive frames through newly created stages and returns the last frame. `signals`: signals
/// of the frames in kelvin above the background; the last signal belongs to the returned frame, whose noise has index
/// 0. The gain is computed from the last frame with the scene at rest and without the scene, both with the same noise.
/// Errors: those of the stages; `not_identifiable` (no contrast after the stages).
[[nodiscard]] Result<StagedFrame> behind_stages(const SensorModel& model,
                                                const std::function<std::vector<std::unique_ptr<ChainStage>>()>& stages,
                                                const std::vector<cv::Mat1f>& signals, double background_k,
                                                const cv::Rect& field);

}  // namespace todbench
