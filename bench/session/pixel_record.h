// Bad and substituted pixels, and maps of pixels, in measures.json.
#pragma once

#include <string>
#include <vector>

#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// A picture of a property of each pixel, as a PNG file in base64.
struct PixelMap {
  std::string name;  ///< "temporal_noise", "fixed_pattern", "triangles", "defects"
  int width = 0, height = 0;
  double black_k = 0, white_k = 0;  ///< what the grey scale means; both 0: the picture has colours
  std::string png;
  std::string note{};  ///< what else has to be said, a clause
};

/// What the colours of the map of defects mean, in the order in which they are drawn: name of the kind and colour in
/// words.
struct DefectColour {
  PixelDefect kind;
  std::string_view words;
  unsigned char red, green, blue;
};
[[nodiscard]] const std::array<DefectColour, pixel_defect_kinds.size()>& defect_colours();

/// Those that the measures give: noise and pattern with the noise, triangles of every contrast, defects with the
/// pixels.
[[nodiscard]] std::vector<PixelMap> pixel_maps(const CameraMeasures& measures);
[[nodiscard]] Json pixel_maps_json(const std::vector<PixelMap>& maps);
/// Empty where the reader has a mistake.
[[nodiscard]] std::vector<PixelMap> pixel_maps_from(const JsonReader& maps);
/// PNG files as base64, of one pixel or more.
[[nodiscard]] bool drawable(const std::vector<PixelMap>& maps);

/// {"frames", "frame_px", "field_px", "response_tested", "counts", "zones": [...], "defects": [{"x_px", "y_px",
/// "kinds", "cluster"}], "defects_listed", "not_tested"}
[[nodiscard]] Json pixels_json(const PixelMeasure& pixels);

/// A grey PNG as base64; values below `black` are black, above `white` white.
[[nodiscard]] std::string grey_png(const cv::Mat1d& values, double black, double white);

}  // namespace todbench
