// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_dead_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {

cv::Mat1b dead_detectors(cv::Size detectors, double share, const RandomStream& stream) {
  cv::Mat1b dead(detectors, std::uint8_t{0});
  for (int row = 0; row < dead.rows; ++row) {
    for (int column = 0; column < dead.cols; ++column) {
      const auto index =
          static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(dead.cols) + static_cast<std::uint64_t>(column);
      dead(row, column) = stream.uniform(index) < share ? 1 : 0;
    }
  }
  return dead;
}

void replace_dead(cv::Mat1f& picture, const cv::Mat1b& dead, int samples_per_pitch) {
  constexpr std::array<std::array<int, 2>, 4> neighbours{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  for (int row = 0; row < dead.rows; ++row) {
    for (int column = 0; column < dead.cols; ++column) {
      if (dead(row, column) == 0) continue;
      for (int sample = 0; sample < samples_per_pitch * samples_per_pitch; ++sample) {
        const int y = row * samples_per_pitch + sample / samples_per_pitch;
        const int x = column * samples_per_pitch + sample % samples_per_pitch;
        float sum = 0;
        int live = 0;
        for (const auto& [dy, dx] : neighbours) {
          const int r = row + dy, c = column + dx;
          if (r < 0 || c < 0 || r >= dead.rows || c >= dead.cols || dead(r, c) != 0) continue;
          sum += picture(y + dy * samples_per_pitch, x + dx * samples_per_pitch);
          ++live;
        }
        if (live > 0) picture(y, x) = sum / static_cast<float>(live);
      }
    }
  }
}

EffectRow effect_rows::dead_pixels() {
  EffectRow row;
  row.title = "Dead pixels";
  row.keys = {{"dead_pixel_share", &SensorSpec::dead_pixel_share, NumberRange::between(0, 0.1), KeyPresence::optional,
               "share of detectors that the camera replaces by the mean of their working neighbours"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.dead_pixel_share == 0; };
  row.neutralise = [](SensorSpec& spec) { spec.dead_pixel_share = 0; };
  row.neutral = "dead_pixel_share is 0";
  row.stage = stage::Picture{[](const SensorSpec& spec, const NoiseStreams& streams) -> PictureStage {
    return [dead = dead_detectors({spec.width, spec.height}, spec.dead_pixel_share, streams("dead", 0)),
            n = spec.samples_per_pitch()](cv::Mat1f& picture) { replace_dead(picture, dead, n); };
  }};
  // At an edge the replacement of a pixel has an error of a third of the contrast, in all samples of a detector. At
  // high contrast this is more than noise: a dead detector on the target or next to it may cost all correct answers
  // above chance, 0.5 of the answers, and the proportion rises by 1 per ln S.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    const double share = scene.spec.dead_pixel_share, n = scene.spec.samples_per_pitch();
    const double detectors = std::pow(1.5 * scene.s75_pitch + 2, 2) / scene.spec.pitch_aspect();
    return std::max(scene.noise_change(share * n * n / 9.0), 0.5 * share * detectors);
  };
  return row;
}

}  // namespace todbench
