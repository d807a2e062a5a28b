// SPDX-License-Identifier: GPL-3.0-or-later
// Checks whether a plate can be measured at a distance: the plate must fit into the picture, and the window of the
// observer round each triangle must not contain other triangles.
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/observer.h"
#include "tod/measurement/measurement.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/patch_windows.h"

namespace todbench {

/// The plate is larger than the picture.
struct PlateBeyondPicture {
  std::string plate;
  cv::Size2d size_mm;
  cv::Size2d size_px;     ///< size of the plate in the picture at `distance_m`
  double distance_m = 0;  ///< entrance pupil to plate
  cv::Size picture;
};

/// The observer's window round a triangle contains a part of a neighbouring triangle.
struct TrianglesTooNear {
  std::string plate;
  TouchingWindow window;
};

/// Reason why a geometry cannot be measured.
using Misfit = std::variant<PlateBeyondPicture, TrianglesTooNear>;

/// Returns all reasons why this geometry cannot be measured; empty if it can. Plates that are too large are first,
/// because they cause the other reasons. Errors: `invalid_input` (no distance, no IFOV), those of the observer.
[[nodiscard]] Result<std::vector<Misfit>> find_misfits(const MeasurementOptions& options, Observer& observer,
                                                       cv::Size picture);

/// Returns one sentence, for example: "plate tcat-a: its 400 x 300 mm cover 800 x 600 pixels at 2.00 m, but the picture
/// has 640 x 480 pixels"
[[nodiscard]] std::string sentence(const Misfit& misfit);

/// Returns sentences for the first `most` misfits, and states the number of the remaining misfits.
[[nodiscard]] std::string sentences(const std::vector<Misfit>& misfits, std::size_t most);

}  // namespace todbench
