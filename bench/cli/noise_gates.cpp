// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/noise_gates.h"

#include <algorithm>
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

void EndValues::End::add(float seen) {
  if (pixels > 0 && seen == value) {
    ++pixels;
  } else if (pixels == 0 || seen > value) {
    next_value = value, next_pixels = pixels;
    value = seen, pixels = 1;
  } else if (next_pixels > 0 && seen == next_value) {
    ++next_pixels;
  } else if (next_pixels == 0 || seen > next_value) {
    next_value = seen, next_pixels = 1;
  }
}

void EndValues::add(const cv::Mat1f& picture, const cv::Mat1b& usable) {
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      if (!usable.empty() && usable(row, column) == 0) continue;
      high_.add(picture(row, column));
      low_.add(-picture(row, column));
      ++pixels_;
    }
  }
}

double EndValues::clipped_share() const {
  double most = 0;
  for (const End& end : {high_, low_}) {
    const bool collected = end.pixels > end.next_pixels + 5 * std::sqrt(end.pixels + end.next_pixels);
    if (collected) most = std::max(most, end.pixels / pixels_);
  }
  return most;
}

std::optional<NoiseFault> noise_fault(const NoiseLimits& limits, double noise) {
  const double most_clipped = IntegrityOptions{}.max_saturated_share;
  if (limits.saturated_share > most_clipped) {
    return NoiseFault{"saturated",
                      fixed(100 * limits.saturated_share, 1) +
                          " % of the pixels are saturated (lowest or highest count): their noise is clipped, so no "
                          "noise is reported"};
  }
  if (noise < least_measurable_noise_counts * limits.unit_per_count * limits.counts_per_step) {
    return NoiseFault{"too_coarse",
                      limits.counts_per_step <= 1
                          ? "the noise is below half a count: the counts are too coarse to measure it"
                          : "the counts change in steps of " + std::to_string(limits.counts_per_step) +
                                ", and the noise is below half a step: the steps are too coarse to measure it"};
  }
  if (limits.clipped_share > most_clipped) {
    return NoiseFault{
        "saturated",
        fixed(100 * limits.clipped_share, 1) +
            " % of the pixels have the highest or the lowest value of the recording, and significantly fewer have the "
            "neighbouring value: their noise is clipped below full scale, so no noise is reported"};
  }
  return std::nullopt;
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
