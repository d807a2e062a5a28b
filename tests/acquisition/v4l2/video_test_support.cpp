#include "tests/acquisition/v4l2/video_test_support.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace todbench::testing_support {

cv::Mat1w video_picture(std::uint64_t index, int width, int height, int bits) {
  const unsigned mask = (1U << static_cast<unsigned>(bits)) - 1;
  cv::Mat1w picture(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto value =
          257U * static_cast<unsigned>(index) + 7U * static_cast<unsigned>(x) + 1031U * static_cast<unsigned>(y);
      picture(y, x) = static_cast<ushort>(value & mask);
    }
  }
  return picture;
}

VideoBench start_video(const VideoCameraConfig& config) {
  VideoBench bench{.system = MockSystem::create(), .camera = nullptr};
  auto camera =
      EmulatedV4l2Camera::start(bench.system, config,
                                [width = config.width, height = config.height, bits = significant_bits(config.kind)](
                                    std::uint64_t index) { return video_picture(index, width, height, bits); });
  if (!camera) {
    ADD_FAILURE() << camera.error().message;
    return bench;
  }
  bench.camera = std::move(*camera);
  return bench;
}

std::string video_camera_id(const VideoCameraConfig& config) {
  std::string id = "v4l2:" + config.vendor + "-" + config.model + "-" + config.serial;
  std::replace(id.begin(), id.end(), ' ', '_');
  return id;
}

std::unique_ptr<FrameSource> open_video(const VideoCameraConfig& config, const V4l2Options& options) {
  auto source = v4l2_backend(options)->open(video_camera_id(config));
  if (!source) {
    ADD_FAILURE() << source.error().message;
    return nullptr;
  }
  return std::move(*source);
}

}  // namespace todbench::testing_support
