// A camera whose pictures go through stages.
#pragma once

#include <memory>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "sim_devices/module/picture_stage.h"

namespace todbench {

/// What the stages did so far.
struct ProcessingRecord {
  std::vector<double> frame_ms;  ///< of every complete frame, all stages together
  std::size_t clipped = 0;       ///< pixels beyond the counts of the camera, which were cut off
  cv::Mat1w picture;             ///< what was made of the frame with the number that was asked for
};

/// What becomes of the answers of the stages.
enum class ProcessedAs {
  judged,  ///< Frame::judged: plate, contrast, noise and corrections are found in the counts as they came
  counts,  ///< Frame::counts, as if the camera had sent them: stages of one sample a pixel
};

/// Samples per pixel and axis of what stages answer together.
[[nodiscard]] int samples_per_pixel(const std::vector<std::unique_ptr<ChainStage>>& stages);

/// `camera` with every complete frame through all stages, one after the other; answers are rounded to counts and cut
/// off at the ends of their range. Frames that are not complete stay as they are. Errors of a stage are errors of
/// next(). The picture of the record is that of the frame with number `picture_frame`, counted from 0.
[[nodiscard]] std::unique_ptr<FrameSource> processed_source(std::unique_ptr<FrameSource> camera,
                                                            std::vector<std::unique_ptr<ChainStage>> stages,
                                                            ProcessedAs as, std::size_t picture_frame,
                                                            std::shared_ptr<ProcessingRecord> record);

}  // namespace todbench
