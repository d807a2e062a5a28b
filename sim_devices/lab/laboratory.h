// The emulated laboratory: a camera, a black body and a plate stage, each on its real protocol, around one
// simulated sensor. What the instruments show is what the camera sees, also while they settle. Runs of the stage are
// in the time of the camera, whose clock advances by a frame with every exposure: a busy host makes them slower, not
// wrong.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "sim_devices/lab/correction_drift.h"
#include "sim_devices/lab/gige/gige_camera.h"
#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/plate_stage.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/lab/monitor_view.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/target_plate.h"

namespace todbench {

struct LaboratoryOptions {
  SensorSpec sensor;
  SensorPlan plan;  ///< of the camera's effects; those of motion act while the stage runs
  Accuracy accuracy;
  std::vector<TargetPlate> plates;  ///< in the slots of the stage, identity mounting
  double distance_m = 2;
  cv::Point2d centre_px{0.3, -0.2};  ///< aim of the camera: where the plate's middle is, from the middle of the picture
  double rotation_deg = 0.4;         ///< of the plate about the line of sight
  /// Another camera than the GigE Vision one. Its counts must be those of `sensor`.
  ConnectCamera connect;
  EmulatedGigeCameraConfig camera;  ///< geometry, rate and scale are filled in from the sensor
  /// Kelvin that the camera states over true ones, from `scene_temperature_k` of the sensor on; > 0. Of cameras that
  /// state what a count is: where the kind of camera fixes it, nothing is stated otherwise.
  double stated_scale = 1;
  BlackBodyOptions black_body;
  PlateStageOptions stage;  ///< plates are filled in
  /// In place of black body and plate before the camera, upright. The instruments are there and show nothing.
  std::optional<Monitor> monitor{};
  /// In the time of the camera; from a correction of the GigE Vision camera on, of others from power-up on.
  CorrectionDrift drift;
  std::uint64_t seed = 1;
};

/// Runs from creation to destruction. Thread-safe, but for switching the camera: one thread at a time.
class Laboratory {
 public:
  /// Precondition: validate(sensor) succeeds. Errors: `not_found` (address or port in use), `invalid_input` (options).
  [[nodiscard]] static Result<std::unique_ptr<Laboratory>> start(LaboratoryOptions options);
  ~Laboratory();
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;

  /// "gige:VENDOR-SERIAL".
  [[nodiscard]] std::string camera_id() const;
  /// IPv4 address of the camera, or its device node.
  [[nodiscard]] std::string camera_address() const;
  /// What a plan has to state of the camera: [camera.settings].
  [[nodiscard]] std::map<std::string, std::string> camera_settings() const;
  /// What a client in another process needs in its environment.
  [[nodiscard]] std::map<std::string, std::string> client_environment() const;
  /// "address:port".
  [[nodiscard]] std::string black_body_endpoint() const;
  [[nodiscard]] std::string stage_endpoint() const;
  /// What is in front of the camera now.
  [[nodiscard]] PlateScene scene() const;
  [[nodiscard]] const SensorModel& model() const;

  /// Switches the camera off without a word to its client, as a pulled cable does.
  void switch_camera_off();
  /// Switches the same camera on again, with the same serial number and the settings of power-up; harmless when it is
  /// on. Its exposures go on where they ended. Errors: those of start().
  [[nodiscard]] Result<void> switch_camera_on();

 private:
  struct State;
  explicit Laboratory(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace todbench
