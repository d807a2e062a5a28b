// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory of `emulate`, `demo` and the window.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/plan.h"
#ifdef TODBENCH_WITH_ARAVIS
#include "sim_devices/lab/laboratory.h"
#endif

namespace todbench {

/// Returns the names for `--camera` of the cameras that this build can emulate: "gige", "gige-ax5" and other families
/// on plain sockets, "u3v" (USB3 Vision), "seek" (a CompactPRO; the sensor must have 320 x 240 pixels), "v4l2" (Y16
/// with telemetry, like a Lepton), "v4l2-yuyv" (temperatures below a picture, like a Tiny1).
[[nodiscard]] std::vector<std::string> emulated_cameras();

/// Restarts the program under the preload library if `camera` needs an emulated device node. Call it first in main().
void enter_emulation(const std::string& camera);

/// Arguments of `todbench emulate`.
struct EmulationArguments {
  std::string camera = "gige";                  ///< one of emulated_cameras()
  std::string sensor = "sc2000";                ///< name or file
  std::string interface_address = "127.0.0.1";  ///< IPv4 address of the interface of the camera
  std::string serial = "TB0001";                ///< serial number of the camera
  /// Plates of the stage, by name or file. The default is all shipped plates.
  std::vector<std::string> plates{"tcat-a", "tcat-b", "edge", "bars", "apertures", "mrtd", "open", "tcat-c", "tcat-d"};
  double distance_m = 2;  ///< distance from camera to plate, or focal length of the collimator
  std::uint16_t black_body_port = 5025, stage_port = 5026;  ///< 0: the system chooses
  /// Standard deviation of the stage position while the stage moves.
  double stage_jitter_mm = 0;
  /// Collimator in front of the plate: transmission, temperature of the mirrors, and blur. `distance_m` is then the
  /// focal length.
  double collimator_transmission = 1, collimator_mirror_c = 21.85, collimator_blur_mrad = 0;
  double latency_ms = 0;                      ///< latency of the time stamps of frames
  bool celsius = false;                       ///< the black body reports absolute temperatures in degrees Celsius
  double black_body_time_constant_s = 0.004;  ///< time constant of the approach to a set-point, > 0
  /// Drift of the camera after a correction: initial rates of the mean of the picture and of the standard deviation
  /// over the pixels (K/min), and their time constant (s; 0: linear drift).
  double drift_k_per_min = 0, drift_pattern_k_per_min = 0, drift_time_constant_s = 0;
  bool trigger = true;  ///< the stage reports the start of a run in the camera's clock
  /// Picture in .npy format, levels from 0 to 1, shown by a monitor in front of the camera. The file is read again
  /// after each change. If the file does not exist, the monitor is black. Empty: the plates are in front of the camera.
  std::string monitor_file{};
  double monitor_pixel_mm = 0.25, monitor_span_k = 20, monitor_gamma = 1;  ///< see Monitor
  std::uint64_t seed = 1;
  bool operator==(const EmulationArguments&) const = default;
};

/// Returns the laboratory for a plan: its sensor, plates and distance, on ports that the system chooses.
[[nodiscard]] EmulationArguments emulation_for(const Plan& plan);

/// Length of the demonstration.
enum class DemonstrationLength {
  quick,  ///< without the parts of the plan 'acceptance' that need many additional frames
  full,   ///< the plan 'acceptance'
};
/// Returns the plan of `todbench demo`; quick: the plan 'demo' with the budget, noise, geometry and pictures of
/// 'acceptance'.
[[nodiscard]] Result<Plan> demonstration_plan(DemonstrationLength length);

#ifdef TODBENCH_WITH_ARAVIS
/// Returns the options of start_laboratory(). Errors: those of sensor and plates.
[[nodiscard]] Result<LaboratoryOptions> laboratory_options(const EmulationArguments& arguments);

/// Starts camera, black body and plate stage. These devices settle faster than those of a real bench. The black body
/// has a time constant of 4 ms and is stable after 10 ms. A change of plate or mounting takes 50 ms. The stage moves at
/// 1 m/s and comes to rest in 5 ms. A shift of some millimetres takes less than a frame of 20 ms.
[[nodiscard]] Result<std::unique_ptr<Laboratory>> start_laboratory(const EmulationArguments& arguments);

/// Returns the plan with the camera and instruments of a laboratory.
[[nodiscard]] Plan with_laboratory(Plan plan, const Laboratory& laboratory);
#endif

}  // namespace todbench
