// SPDX-License-Identifier: GPL-3.0-or-later
// What tests with an emulated GigE camera share: a private network, a camera in a process of its own.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/aravis/aravis_backend.h"
#include "sim_devices/lab/gige/gige_camera.h"
#include "tests/support/camera_passages.h"

namespace todbench::testing_support {

/// The exposures of a camera that shows test_picture().
[[nodiscard]] EmulatedGigeCamera::Exposure test_exposures(const EmulatedGigeCameraConfig& config);

/// A camera that shows test_picture(); fails the test when it cannot start.
[[nodiscard]] std::unique_ptr<EmulatedGigeCamera> start_camera(const EmulatedGigeCameraConfig& config);

/// Opens the camera on loopback by address, without waiting for a discovery; fails the test when it cannot.
[[nodiscard]] std::unique_ptr<FrameSource> open_camera(const AravisOptions& options = {});

/// A camera with the default configuration, test_picture() and `frame_rate_hz` in another process.
class CameraProcess {
 public:
  explicit CameraProcess(double frame_rate_hz);
  ~CameraProcess();
  CameraProcess(const CameraProcess&) = delete;
  CameraProcess& operator=(const CameraProcess&) = delete;
  /// True when the camera answers.
  [[nodiscard]] bool started() const { return started_; }
  /// SIGKILL: no goodbye, nothing flushed. Returns when the process has gone.
  void kill();

 private:
  pid_t pid_ = -1;
  int output_ = -1;
  bool started_ = false;
};

}  // namespace todbench::testing_support
