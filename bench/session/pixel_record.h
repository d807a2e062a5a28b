// SPDX-License-Identifier: GPL-3.0-or-later
// Defective pixels, substituted pixels and pixel maps in measures.json.
#pragma once

#include <string>
#include <vector>

#include "bench/text/json_fields.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Map of a property of each pixel, as a PNG file in base64.
struct PixelMap {
  std::string name;  ///< "temporal_noise", "fixed_pattern", "triangles", "defects"
  int width = 0, height = 0;
  double black_k = 0, white_k = 0;  ///< levels displayed as black and as white; both 0: a colour picture
  std::string png;
  std::string note{};  ///< additional remark; empty: none
};

/// Colours of the defect map in the order of drawing: kind, colour in words, RGB.
struct DefectColour {
  PixelDefect kind;
  std::string_view words;
  unsigned char red, green, blue;
};
/// Returns the colour of every kind of defect.
[[nodiscard]] const std::array<DefectColour, pixel_defect_kinds.size()>& defect_colours();

/// Returns the available maps: noise and pattern if noise was measured, triangles of every contrast, defects if pixels
/// were checked.
[[nodiscard]] std::vector<PixelMap> pixel_maps(const CameraMeasures& measures);
/// Describes a map in measures.json.
void pixel_map_fields(JsonFields& json, PixelMap& map);
/// Returns whether the maps are base64 PNG files of at least one pixel.
[[nodiscard]] bool drawable(const std::vector<PixelMap>& maps);

/// Returns a grey PNG in base64; values below `black` are black, above `white` white.
[[nodiscard]] std::string grey_png(const cv::Mat1d& values, double black, double white);

}  // namespace todbench
