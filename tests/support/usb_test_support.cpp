// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usb_test_support.h"

#include "acquisition/usb/usb_backend.h"

namespace todbench::testing_support {

std::shared_ptr<MockSystem> shared_system() {
  static const std::shared_ptr<MockSystem> system = MockSystem::create();
  return system;
}

cv::Mat1w seek_picture(SeekModel model, std::uint64_t index) {
  const cv::Size size = geometry(model).picture.size();
  cv::Mat1w picture(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto value =
          257U * static_cast<unsigned>(index) + 7U * static_cast<unsigned>(x) + 1031U * static_cast<unsigned>(y);
      picture(y, x) = static_cast<ushort>(1 + value % 16381);
    }
  }
  return picture;
}

UsbBench<SeekCamera> plug_seek(const SeekCameraConfig& config, SeekCamera::Exposure exposure) {
  if (!exposure) exposure = [model = config.model](std::uint64_t index) { return seek_picture(model, index); };
  return plug(SeekCamera::create(config, std::move(exposure)));
}

std::string seek_id(const SeekCameraConfig& config) {
  return seek_camera_id(config.model, config.serial);
}

std::unique_ptr<FrameSource> open_seek(const SeekCameraConfig& config) {
  return opened(usb_backend()->open(seek_id(config)));
}

}  // namespace todbench::testing_support
