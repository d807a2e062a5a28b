// SPDX-License-Identifier: GPL-3.0-or-later
// What tests with the GigE Vision camera on plain sockets share.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "sim_devices/lab/gige/gvsp_camera.h"
#include "tests/support/gige_test_support.h"

namespace todbench::testing_support {

/// Pictures of test_picture() in the counts of the configuration.
[[nodiscard]] inline GvspCamera::Exposure gvsp_test_exposures(const GvspCameraConfig& config) {
  return [width = config.width, height = config.height, bits = config.significant_bits](std::uint64_t index) {
    return test_picture(index, width, height, bits);
  };
}

/// A camera that shows test_picture(); fails the test when it cannot start.
[[nodiscard]] inline std::unique_ptr<GvspCamera> start_gvsp_camera(const GvspCameraConfig& config) {
  auto camera = GvspCamera::start(config, gvsp_test_exposures(config));
  if (!camera) {
    ADD_FAILURE() << camera.error().message;
    return nullptr;
  }
  return std::move(*camera);
}

}  // namespace todbench::testing_support
