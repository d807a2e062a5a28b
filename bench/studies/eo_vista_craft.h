// Figure 12 of the EO-VISTA paper: a small craft by the SC2000 at 400 m and with microscan at 640 m.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/scene_pictures.h"

namespace todbench {

/// One picture of the figure, with black and white in kelvin above the background.
struct CraftPicture {
  std::string name;  ///< of its file
  std::string title, caption;
  double range_m = 0;
  cv::Mat1f kelvin;
  double grey_low_k = 0, grey_high_k = 1;
};

/// The scene at the sensor (as at 400 m), then what both sensors display, on one grey scale; every picture shows the
/// same metres. The craft is `craft-01` of this program: that of the paper is not published in numbers.
[[nodiscard]] Result<std::vector<CraftPicture>> eo_vista_craft(Accuracy accuracy, std::uint64_t seed);

}  // namespace todbench
