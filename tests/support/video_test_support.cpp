// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/video_test_support.h"

#include <gtest/gtest.h>

#include "acquisition/core/camera_id.h"

namespace todbench::testing_support {

int picture_bits(VideoCameraKind kind) {
  return kind == VideoCameraKind::temperature_rows ? 14 : significant_bits(kind);
}

VideoBench start_video(const VideoCameraConfig& config, const VideoDriverQuirks& quirks) {
  VideoBench bench{.system = MockSystem::create(), .camera = nullptr};
  auto camera = EmulatedV4l2Camera::start(
      bench.system, config,
      [width = config.width, height = config.height, bits = picture_bits(config.kind)](std::uint64_t index) {
        return test_picture(index, width, height, bits);
      },
      quirks);
  if (!camera) {
    ADD_FAILURE() << camera.error().message;
    return bench;
  }
  bench.camera = std::move(*camera);
  return bench;
}

std::string video_camera_id(const VideoCameraConfig& config) {
  return camera_id(camera_scheme::v4l2, {config.vendor, config.model, config.serial});
}

std::unique_ptr<FrameSource> open_video(const VideoCameraConfig& config, const V4l2Options& options) {
  return opened(v4l2_backend(options)->open(video_camera_id(config)));
}

}  // namespace todbench::testing_support
