// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/noise_gates.h"

#include <cmath>

#include "acquisition/core/integrity_gate.h"
#include "bench/report/number_format.h"
#include "tod/measures/pixel_noise.h"

namespace todbench {

double kelvin_per_count(const Frame& frame, const RadiometricScale& scale) {
  return std::abs(scale.kelvin_per_count(cv::mean(frame.counts)[0]).value_or(0));
}

cv::Mat1b saturated_pixels(const Frame& frame) {
  const double full = std::pow(2.0, frame.significant_bits) - 1;
  const cv::Mat1b ends = (frame.counts == 0) | (frame.counts >= full);
  return ends & 1;
}

bool noise_clipped(double saturated_share) {
  return saturated_share > IntegrityOptions{}.max_saturated_share;
}

bool noise_too_coarse(double noise, double unit_per_count) {
  return noise < least_measurable_noise_counts * unit_per_count;
}

std::string clipped_sentence(double saturated_share) {
  return fixed(100 * saturated_share, 1) +
         " % of the pixels are saturated (lowest or highest count): their noise is clipped, so no noise is reported";
}

std::string frozen_sentence(int repeated) {
  return repeated == 0
             ? ""
             : std::to_string(repeated) + (repeated == 1 ? " frame repeats" : " frames repeat") +
                   " the frame before bit for bit (frozen) and " + (repeated == 1 ? "is" : "are") + " left out";
}

Error too_few_frames(int frames, int repeated) {
  return {ErrorCode::invalid_input,
          "the noise cannot be computed: it needs at least two different frames without a correction (NUC) between "
          "them, found " +
              std::to_string(frames) + (repeated > 0 ? "; " : "") + frozen_sentence(repeated)};
}

}  // namespace todbench
