// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 12 of the EO-VISTA paper: a small craft observed by the SC2000 at 400 m, and with microscan at 640 m.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/scene_pictures.h"

namespace todbench {

/// One picture of the figure, with black and white in kelvin above the background.
struct CraftPicture {
  std::string name;  ///< name of its file without extension
  std::string title, caption;
  /// Range from the camera to the craft, in m; 0 for the scene without a camera.
  double range_m = 0;
  cv::Mat1f kelvin;
  double grey_low_k = 0, grey_high_k = 1;
};

/// Returns three pictures on one grey scale: the scene without a camera, the display of the SC2000 at 400 m, and its
/// display with microscan at 640 m. All show the same field in metres. The craft is `craft-01`, because the paper does
/// not publish the data of its craft.
[[nodiscard]] Result<std::vector<CraftPicture>> eo_vista_craft(Accuracy accuracy, std::uint64_t seed);

}  // namespace todbench
