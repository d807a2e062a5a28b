// SPDX-License-Identifier: GPL-3.0-or-later
// Super-resolution as a stage of the chain: combination of the last frames, which are displaced relative to each other,
// into a finer picture.
#pragma once

#include <memory>

#include "sim_devices/module/picture_stage.h"

namespace todbench {

/// Source of the shifts of the frames.
enum class FrameShifts {
  measured,  ///< estimated by frame_shifts()
  scan,      ///< known: dither_px() of the number of the picture, counted from 0
};

/// Options of super_resolution_stage().
struct SuperResolutionStageOptions {
  int frames = 4;  ///< number of the most recent frames that are combined; at least factor^2
  int factor = 2;  ///< samples per pixel and axis
  FrameShifts shifts = FrameShifts::measured;
};

/// Returns the displacement, in pixels, of picture `index` of a camera that is dithered over n x n positions within a
/// pixel, along x first.
[[nodiscard]] cv::Point2d dither_px(int n, std::uint64_t index);

/// Returns a stage that applies super_resolve() to the last frames. Until there are enough frames, it repeats each
/// pixel. Positions in the result refer to the mean shift of the combined frames. Errors of process():
/// `not_identifiable` with the message of super_resolve() or frame_shifts(); the next picture may succeed.
[[nodiscard]] std::unique_ptr<ChainStage> super_resolution_stage(const SuperResolutionStageOptions& options);

}  // namespace todbench
