// SPDX-License-Identifier: GPL-3.0-or-later
// What tests with emulated video cameras share: main() under umockdev's preload library.
#pragma once

#include <memory>

#include "acquisition/v4l2/v4l2_backend.h"
#include "sim_devices/lab/video/v4l2_camera.h"
#include "tests/support/camera_passages.h"

namespace todbench::testing_support {

/// A system of emulated devices with one camera and what it shows.
struct VideoBench {
  std::shared_ptr<MockSystem> system;
  std::unique_ptr<EmulatedV4l2Camera> camera;
};

/// Bits of the test pictures of a camera of this kind. Temperature rows get 14 of their 16: counts of 1/64 K below 256
/// K. More bits would be above what the camera can measure, and steps as high as those beside the picture for people.
[[nodiscard]] int picture_bits(VideoCameraKind kind);

/// A camera that shows test_picture(); fails the test when it cannot start.
[[nodiscard]] VideoBench start_video(const VideoCameraConfig& config = {}, const VideoDriverQuirks& quirks = {});

[[nodiscard]] std::string video_camera_id(const VideoCameraConfig& config);

/// Opens by identity; fails the test when it cannot.
[[nodiscard]] std::unique_ptr<FrameSource> open_video(const VideoCameraConfig& config, const V4l2Options& options = {});

}  // namespace todbench::testing_support
