// SPDX-License-Identifier: GPL-3.0-or-later
// Bad and substituted pixels of a camera, counted by zones of the frame.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measures/pixel_defects.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// A zone in fractions of the frame, from the upper left corner. It contains the pixels whose centres are inside these
/// limits.
struct ZoneArea {
  std::string name;
  double left = 0, top = 0, right = 1, bottom = 1;
  /// Returns the zone in pixels of a frame of this size.
  [[nodiscard]] cv::Rect pixels(cv::Size frame) const;
};

/// Options of measure_pixels().
struct PixelOptions {
  bool whole_frame = false;  ///< a flat field fills the frame; false: only the part covered by the plate is examined
  PixelDefectRules rules;
  std::vector<ZoneArea> zones{};  ///< further zones in addition to the whole frame
};

/// Largest number of frames in which pixels are examined: 80 MB for 320 x 240.
inline constexpr int most_pixel_frames = 256;

/// Result of measure_pixels().
struct PixelMeasure {
  struct Zone {
    ZoneArea area;
    ZoneCount count;
  };
  cv::Size frame{0, 0};
  cv::Rect field;  ///< examined part of the frame
  PixelDefects defects;
  std::vector<Zone> zones;  ///< the whole frame first
};

/// Finds and counts bad and substituted pixels after removal of the shading. `frames`: frames of one noise cube of a
/// flat field, reduced to the window `field`. Errors: those of pixel_defects().
[[nodiscard]] Result<PixelMeasure> measure_pixels(std::span<const cv::Mat1f> frames, cv::Size frame,
                                                  const cv::Rect& field, PixelScene scene, const PixelOptions& options);

/// A mean picture of a plate at a contrast.
struct ContrastPicture {
  double delta_t_k = 0;
  cv::Mat1d kelvin;  ///< picture of the whole frame
};
/// Returns the response to temperature of each pixel that lies inside a triangle, at least two pixels from its outline.
/// The response is the slope of (pixel minus median of the plate) as a function of the contrast. NaN for any other
/// pixel. `field`: part of the frame that is returned; `plate`: part that the plate covers. Precondition: at least two
/// different contrasts.
[[nodiscard]] cv::Mat1d responsivity_in_triangles(std::span<const ContrastPicture> pictures,
                                                  const TargetPlate& mounted_plate, const Registration& where,
                                                  const cv::Rect& field, const cv::Rect& plate);

}  // namespace todbench
