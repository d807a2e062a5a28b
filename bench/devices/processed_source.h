// SPDX-License-Identifier: GPL-3.0-or-later
// Camera whose pictures pass through stages.
#pragma once

#include <memory>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "sim_devices/module/picture_stage.h"

namespace todbench {

/// Record of the processing.
struct ProcessingRecord {
  std::vector<double> frame_ms;  ///< processing time of every complete frame, all stages together
  std::size_t clipped = 0;       ///< pixels clipped at the range of the camera's counts
  cv::Mat1w picture;             ///< output for the requested frame number
};

/// Destination of the output of the stages.
enum class ProcessedAs {
  judged,  ///< Frame::judged; plate, contrast, noise and corrections come from the original counts
  counts,  ///< Frame::counts, as if the camera had sent them, and Frame::judged; for stages with one sample per pixel
};

/// Returns the number of samples per pixel and axis in the output of all stages.
[[nodiscard]] int samples_per_pixel(const std::vector<std::unique_ptr<ChainStage>>& stages);

/// Returns `camera` with every complete frame passed through all stages in order; outputs are rounded to counts and
/// clipped to their range. Incomplete frames are unchanged. next() returns the errors of a stage. The record keeps the
/// picture of frame `picture_frame`, counted from 0.
[[nodiscard]] std::unique_ptr<FrameSource> processed_source(std::unique_ptr<FrameSource> camera,
                                                            std::vector<std::unique_ptr<ChainStage>> stages,
                                                            ProcessedAs as, std::size_t picture_frame,
                                                            std::shared_ptr<ProcessingRecord> record);

}  // namespace todbench
