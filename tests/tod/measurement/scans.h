// SPDX-License-Identifier: GPL-3.0-or-later
// Frames of a camera with a fixed pattern that looks at 2 x 2 places of a pixel in turn, or fails to.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <string>

#include "acquisition/core/judged_picture.h"
#include "sim_devices/sensor/super_resolution_stage.h"
#include "tests/tod/measurement/measurement_bench.h"
#include "tod/measurement/scan_watch.h"

namespace todbench::test {

struct Scan {
  double moves = 1;  ///< of the displacement that is believed: 0: frames at rest
  double fixed_pattern_k = 0.1;
  double contrast_k = 16.9;
  int frames = 16;
  int set_ups = 4;
};

/// Pictures without noise by scan.moves, set-up and place: the same for every seed.
using ScanPictures = std::map<std::array<double, 3>, std::shared_ptr<const cv::Mat1f>>;

/// Why the watch refuses the scan; empty: it does not.
inline std::string refusal_of(const Scan& scan, std::uint64_t seed, ScanPictures& pictures) {
  SensorSpec spec = sc2000();
  spec.fixed_pattern_k = scan.fixed_pattern_k;
  const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::draft(), seed);
  const auto scale = std::make_shared<const RadiometricScale>(
      RadiometricScale::linear({.kelvin_per_count = spec.kelvin_per_count, .offset_k = spec.offset_k}).value());
  RegistrationOptions options;
  options.expected_scale_px_per_mm = 1 / (2 * spec.ifov_mrad());
  ScanWatch watch;
  std::uint64_t exposures = 0;
  for (int set_up = 0; set_up < scan.set_ups; ++set_up) {
    PlateScene scene;
    scene.plate = mounted(two_plates().front(), all_mountings.at(static_cast<std::size_t>(set_up)));
    scene.distance_m = 2;
    scene.centre_px = {0.13 * set_up, 0.31};
    std::array<std::shared_ptr<const cv::Mat1f>, 4> signals;
    for (std::uint64_t k = 0; k < 4; ++k) {
      PlateScene there = scene;
      there.centre_px += scan.moves * dither_px(2, k);
      auto& picture = pictures[{scan.moves, static_cast<double>(set_up), static_cast<double>(k)}];
      if (!picture) picture = model.unit_signal(there);
      signals.at(k) = picture;
    }
    const auto kelvin_of = [&](std::uint64_t k, double contrast_k) {
      Frame frame;
      frame.counts = model.expose(*signals.at(k % 4), contrast_k, scene.background_k, exposures++);
      frame.scale = scale;
      frame.judged =
          std::make_shared<const JudgedPicture>(JudgedPicture{.counts = frame.counts, .scan_px = dither_px(2, k)});
      return std::pair(frame, to_kelvin(frame).value());
    };
    cv::Mat1d mean = cv::Mat1d::zeros(model.size());
    for (std::uint64_t k = 0; k < 4; ++k) mean += kelvin_of(k, 16.9).second / 4;
    const auto registration = register_plate(mean, scene.plate, options);
    if (!registration) return registration.error().message;
    ScanFrames frames;
    for (int k = 0; k < scan.frames; ++k) {
      const auto [frame, kelvin] = kelvin_of(static_cast<std::uint64_t>(k), scan.contrast_k);
      frames.add(frame, kelvin);
    }
    if (const auto looked = watch.look(frames, scene.plate, *registration, options); !looked)
      return looked.error().message;
  }
  return "";
}

inline std::string refusal_of(const Scan& scan, std::uint64_t seed) {
  ScanPictures pictures;
  return refusal_of(scan, seed, pictures);
}

}  // namespace todbench::test
