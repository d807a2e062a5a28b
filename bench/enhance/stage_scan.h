// SPDX-License-Identifier: GPL-3.0-or-later
// Scan for super-resolution: a stage moves the plate by fractions of a pixel between the frames of a camera.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/devices/devices.h"
#include "bench/enhance/package_file.h"

namespace todbench {

/// Parameters of the scan.
struct StageScan {
  int steps = 2;              ///< positions within a pixel along each axis; a presentation needs steps^2 frames or more
  double pixel_mm = 0;        ///< side of a pixel on the plate: distance times the angle of a pixel
  int frames_after_move = 2;  ///< exposures of a free-running camera that are dropped after each move (in flight)
};

/// Replaces camera and target of the bench: before frame k the stage moves the plate by dither_px(steps, k) from the
/// requested position, as super_resolution_stage() assumes with FrameShifts::scan. Frames taken while the target
/// changes are counted in k, but the plate does not move then. Sequence numbers continue without the dropped frames,
/// so that lost frames remain detectable. ScanWatch uses the frames to check whether the plate really moves. Call
/// before the bench is recorded. Returns a note about the scan for the session. Errors: `invalid_input` if the target
/// does not set shifts, or the pixel has no size. A move that fails ends the run with `integrity`, or `interrupted`.
[[nodiscard]] Result<std::string> scan_with_stage(OpenedBench& bench, const StageScan& scan);

/// Returns the required number of positions within a pixel along each axis, for each super-resolution stage of the
/// package that uses a known scan.
[[nodiscard]] std::vector<int> scan_factors(const EnhancementPackage& package);

/// Fails with `invalid_input` if the scan of a package differs from the dither of sensor or stage, because
/// super-resolution would then combine frames at wrong positions.
[[nodiscard]] Result<void> check_scans(const std::vector<EnhancementPackage>& packages, int dither);

/// Returns ExperimentHost::on_opened for a stage that scans steps x steps positions within a pixel. The result calls
/// scan_with_stage(). Errors: `invalid_input` for an observer that cannot judge the frames of a scan.
[[nodiscard]] Result<std::function<Result<std::string>(OpenedBench&)>> scan_on_opened(const LoadedPlan& loaded,
                                                                                      int steps);

}  // namespace todbench
