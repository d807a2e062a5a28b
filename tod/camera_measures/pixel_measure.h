// Bad and substituted pixels of a camera, counted by zones of its frame.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/measures/pixel_defects.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// In fractions of the frame, from its left upper corner. A pixel belongs to it by its centre.
struct ZoneArea {
  std::string name;
  double left = 0, top = 0, right = 1, bottom = 1;
  /// In pixels of a frame of this size.
  [[nodiscard]] cv::Rect pixels(cv::Size frame) const;
};

struct PixelOptions {
  bool whole_frame = false;  ///< a flat field fills the frame; otherwise the part that the plate covers
  PixelDefectRules rules;
  std::vector<ZoneArea> zones{};  ///< beside the whole frame
};

/// Frames of the cube that pixels are told apart in: 80 MB of 320 x 240.
inline constexpr int most_pixel_frames = 256;

struct PixelMeasure {
  struct Zone {
    ZoneArea area;
    ZoneCount count;
  };
  cv::Size frame{0, 0};
  cv::Rect field;  ///< of the frame: what was looked at
  PixelDefects defects;
  std::vector<Zone> zones;  ///< the whole frame first
};

/// `frames`: windows `field` of one cube of a flat field. Shading is taken out here. Errors as pixel_defects().
[[nodiscard]] Result<PixelMeasure> measure_pixels(std::span<const cv::Mat1f> frames, cv::Size frame,
                                                  const cv::Rect& field, PixelScene scene, const PixelOptions& options);

/// A mean picture of a plate at a contrast.
struct ContrastPicture {
  double delta_t_k = 0;
  cv::Mat1d kelvin;  ///< of the whole frame
};
/// Response to temperature of each pixel that sees the middle of a triangle, two pixels and more from its outline:
/// the slope of its change against the plate's median over the contrasts. Not a number for any other pixel. `field`:
/// part of the frame that is returned; `plate`: part that the plate covers. Precondition: two contrasts that differ or
/// more.
[[nodiscard]] cv::Mat1d responsivity_in_triangles(std::span<const ContrastPicture> pictures,
                                                  const TargetPlate& mounted_plate, const Registration& where,
                                                  const cv::Rect& field, const cv::Rect& plate);

}  // namespace todbench
