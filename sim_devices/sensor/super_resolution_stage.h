// Super-resolution as a stage of the chain: the last frames, which are shifted against each other, to one finer
// picture.
#pragma once

#include <memory>

#include "sim_devices/module/picture_stage.h"

namespace todbench {

/// Where the shifts of the frames come from.
enum class FrameShifts {
  measured,  ///< frame_shifts()
  scan,      ///< known: dither_px() of the number of the picture, the first picture being number 0
};

struct SuperResolutionStageOptions {
  int frames = 4;  ///< the last so many; factor^2 or more
  int factor = 2;  ///< samples per pixel and axis
  FrameShifts shifts = FrameShifts::measured;
};

/// The displacement of picture `index` of a camera that is dithered over n x n places of a pixel, along x first.
[[nodiscard]] cv::Point2d dither_px(int n, std::uint64_t index);

/// super_resolve() of the last frames; before there are as many, each sample is a pixel repeated. A place of the answer
/// is that in the mean of the frames that it was made of. Errors of process(): `not_identifiable` with what
/// super_resolve() and frame_shifts() say; the next picture may do.
[[nodiscard]] std::unique_ptr<ChainStage> super_resolution_stage(const SuperResolutionStageOptions& options);

}  // namespace todbench
