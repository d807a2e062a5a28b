// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory: a camera, a black body and a plate stage around one simulated sensor, each with its real
// protocol. The camera observes the state of the instruments, also while they settle. Runs of the stage use the clock
// of the camera, which advances by one frame per exposure. A busy host therefore slows the runs down, but their results
// stay correct.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "sim_devices/lab/correction_drift.h"
#include "sim_devices/lab/gige/gige_camera.h"
#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/plate_stage.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/lab/monitor_view.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Options of the laboratory.
struct LaboratoryOptions {
  SensorSpec sensor;
  SensorPlan plan;  ///< effects of the camera; effects of motion apply while the stage runs
  Accuracy accuracy;
  std::vector<TargetPlate> plates;  ///< plates in the slots of the stage, in identity mounting
  double distance_m = 2;
  cv::Point2d centre_px{0.3, -0.2};  ///< middle of the plate in the picture, from the middle of the picture
  double rotation_deg = 0.4;         ///< rotation of the plate about the line of sight
  /// Connects a camera other than the GigE Vision camera. This camera must send the counts of `sensor`.
  ConnectCamera connect;
  EmulatedGigeCameraConfig camera;  ///< the sensor sets geometry, rate and scale
  /// Error of the stated scale: stated kelvin over true kelvin, both measured from `scene_temperature_k` of the sensor;
  /// > 0. Affects only cameras that state their scale, and no scale that is fixed by the kind of camera.
  double stated_scale = 1;
  /// Mirrors between target and camera; a transmission of 1: none.
  double mirror_transmission = 1, mirror_temperature_k = 295;
  double latency_s = 0;  ///< time from exposure to time stamp of a frame, in addition to the latency of the camera
  BlackBodyOptions black_body;
  PlateStageOptions stage;  ///< the plates of the stage are set from `plates`
  /// Upright monitor in front of the camera instead of black body and plate. The instruments run without effect.
  std::optional<Monitor> monitor{};
  /// Returns the counts that a faulty camera sends for an exposure of `scene`. Called on the camera's thread in the
  /// order of the exposures. Empty: the counts as exposed. Not called with a monitor.
  std::function<cv::Mat1w(cv::Mat1w counts, const PlateScene& scene)> sent_counts{};
  /// Drift over the time of the camera. It starts at the last correction for the GigE Vision camera, and at power-up
  /// for other cameras.
  CorrectionDrift drift;
  std::uint64_t seed = 1;
};

/// Laboratory that runs from creation to destruction. Thread-safe, except that only one thread at a time may switch the
/// camera.
class Laboratory {
 public:
  /// Precondition: validate(sensor) succeeds. Errors: `not_found` (address or port in use), `invalid_input` (options).
  [[nodiscard]] static Result<std::unique_ptr<Laboratory>> start(LaboratoryOptions options);
  ~Laboratory();
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;

  /// Returns "gige:VENDOR-SERIAL".
  [[nodiscard]] std::string camera_id() const;
  /// Returns the IPv4 address of the camera, or its device node.
  [[nodiscard]] std::string camera_address() const;
  /// Returns the settings that the plan must state for the camera: [camera.settings].
  [[nodiscard]] std::map<std::string, std::string> camera_settings() const;
  /// Returns the environment variables for a client in another process.
  [[nodiscard]] std::map<std::string, std::string> client_environment() const;
  /// Return "address:port".
  [[nodiscard]] std::string black_body_endpoint() const;
  [[nodiscard]] std::string stage_endpoint() const;
  /// Returns the present scene in front of the camera.
  [[nodiscard]] PlateScene scene() const;
  [[nodiscard]] const SensorModel& model() const;

  /// Switches the camera off without notice to its client, as a pulled cable does.
  void switch_camera_off();
  /// Switches the same camera on again, with the same serial number and the settings at power-up. Has no effect on a
  /// camera that is on. The count of exposures continues. Errors: those of start().
  [[nodiscard]] Result<void> switch_camera_on();

 private:
  struct State;
  explicit Laboratory(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
