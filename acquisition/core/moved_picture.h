// SPDX-License-Identifier: GPL-3.0-or-later
// Detects pictures of a still scene that are cyclically shifted, rotated or mirrored, for example because reading began
// at a wrong position.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace todbench {

/// Compares each picture with the last picture that was in the same position as the first picture. Two pictures with
/// independent temporal noise have a mean absolute difference d. No rearrangement of the pixels reduces d. A rearranged
/// picture differs by more than d; when the rearrangement is reversed, it differs by d again. At least 4000 pixels are
/// compared, so d scatters by 0.76 / sqrt(4000) = 1.2 %. The minimum over 4000 rearrangements is above 1 - 4.5 * 1.2 %
/// = 0.95 of d. A ratio below 0.8 is therefore not due to noise. If few pixels contribute most of d (noise below the
/// step of the counts, a row of telemetry), d scatters more. The ratio must then be lower by 4.5 measured standard
/// errors. Only rearrangements that increase d by a quarter are detected. In a flat field without fixed pattern, a
/// rearrangement has no effect. Pictures of fewer than 1000 pixels are not judged. One thread at a time.
class MovedPicture {
 public:
  /// Returns a description of the displacement from the reference ("it wraps around vertically, shifted by 40 px");
  /// empty if there is none.
  [[nodiscard]] std::optional<std::string> see(const cv::Mat1w& counts);

 private:
  cv::Mat1w reference_;
  std::optional<double> least_difference_;  ///< smallest difference of two pictures without displacement
  int compared_ = 0;
};

}  // namespace todbench
