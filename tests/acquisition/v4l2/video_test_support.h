// What tests with emulated video cameras share: main() under umockdev's preload library, a picture with a known value
// everywhere.
#pragma once

#include <memory>

#include "acquisition/v4l2/v4l2_backend.h"
#include "sim_devices/lab/video/v4l2_camera.h"

namespace todbench::testing_support {

/// A system of emulated devices with one camera and what it shows.
struct VideoBench {
  std::shared_ptr<MockSystem> system;
  std::unique_ptr<EmulatedV4l2Camera> camera;
};

/// Picture `index`: no pixel has the value of its neighbours, so that a shifted, torn, repeated or byte-swapped frame
/// differs.
[[nodiscard]] cv::Mat1w video_picture(std::uint64_t index, int width, int height, int bits);

/// A camera that shows video_picture(); fails the test when it cannot start.
[[nodiscard]] VideoBench start_video(const VideoCameraConfig& config = {});

/// "v4l2:VENDOR-MODEL-SERIAL" of a configuration whose names need no replacement but blanks.
[[nodiscard]] std::string video_camera_id(const VideoCameraConfig& config);

/// Opens by identity; fails the test when it cannot.
[[nodiscard]] std::unique_ptr<FrameSource> open_video(const VideoCameraConfig& config, const V4l2Options& options = {});

}  // namespace todbench::testing_support
