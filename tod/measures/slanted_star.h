// SPDX-License-Identifier: GPL-3.0-or-later
// MTF along several directions from a star of sectors (slanted star, similar to ISO 12233:2023).
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measures/slanted_edge.h"

namespace todbench {

/// Position of a star in a picture. A star consists of bright and dark sectors round a centre.
struct StarPlace {
  cv::Point2d centre_px;  ///< measured from the centre of the first pixel
  double radius_px = 0;
};

/// Direction of an MTF relative to the line from the middle of the picture to the star.
enum class StarDirection {
  tangential,  ///< along that line, within 22.5 degrees (meridional)
  sagittal,    ///< across that line, within 22.5 degrees
  oblique,     ///< between tangential and sagittal
  central,     ///< undefined, because the star contains the middle of the picture
};
[[nodiscard]] std::string_view to_string(StarDirection direction);

/// One edge of a star.
struct StarEdge {
  double edge_deg = 0;    ///< direction from the centre outwards, from +x towards +y (down), 0 to 360
  double normal_deg = 0;  ///< direction of the MTF, from +x towards +y, 0 to 180
  StarDirection direction = StarDirection::central;
  cv::Rect region{};                      ///< part of the picture that contains only this edge
  std::optional<SlantedEdge> measured{};  ///< result of slanted_edge(); empty: rejected
  std::string rejected{};                 ///< reason for the rejection; otherwise empty
};

/// Finds the edges on circles round the centre and measures each edge in a separate region (slanted_edge()). Edges are
/// in the order of edge_deg. Errors: `invalid_input` (a star that extends beyond the picture, a radius below 30 pixels,
/// an odd number of edges or fewer than 4, edges closer than 15 degrees, or no edge that can be measured).
[[nodiscard]] Result<std::vector<StarEdge>> slanted_star(const cv::Mat1d& picture, const StarPlace& star,
                                                         const SlantedEdgeOptions& options);

}  // namespace todbench
