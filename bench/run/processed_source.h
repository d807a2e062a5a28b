// A camera whose pictures go through stages.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "sim_devices/module/picture_stage.h"

namespace todbench {

/// What the stages did so far, and what is wanted of them.
struct ProcessingRecord {
  /// Whether next() hands out what the stages made of a frame, or the frame as it came. The stages see every frame.
  std::atomic<bool> handed_out{true};
  std::vector<double> frame_ms;  ///< of every complete frame, all stages together
  std::size_t clipped = 0;       ///< pixels beyond the counts of the camera, which were cut off
  cv::Mat1w picture;             ///< what was made of the frame with the number that was asked for
};

/// `camera` with the counts of every complete frame through all stages, one after the other; answers are rounded to
/// counts and cut off at the ends of their range. Where the camera does not tell of its corrections, `correction` of
/// a frame whose answer is handed out says what is seen in the pictures as they came. Frames that are not complete stay
/// as they are. Errors of a stage are errors of next(). `record` outlives the source; its picture is that of the frame
/// with number `picture_frame`, counted from 0.
[[nodiscard]] std::unique_ptr<FrameSource> processed_source(std::unique_ptr<FrameSource> camera,
                                                            std::vector<std::unique_ptr<ChainStage>> stages,
                                                            std::size_t picture_frame, ProcessingRecord& record);

}  // namespace todbench
