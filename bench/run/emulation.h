// The emulated laboratory as `emulate`, `demo` and the window start it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/plan.h"
#ifdef TODBENCH_WITH_ARAVIS
#include "sim_devices/lab/laboratory.h"
#endif

namespace todbench {

/// The cameras that can be emulated in this build, by the names of `--camera`: "gige", "gige-ax5" and other families on
/// plain sockets, "u3v" (USB3 Vision), "seek" (a CompactPRO; the sensor has to have 320 x 240 pixels), "v4l2" (Y16 with
/// telemetry, as a Lepton sends it), "v4l2-yuyv" (temperatures below a picture, as a Tiny1 does).
[[nodiscard]] std::vector<std::string> emulated_cameras();

/// Makes this process one that can look at an emulated device node: starts the program again under the preload library
/// where `camera` needs it. Call it before anything else is done.
void enter_emulation(const std::string& camera);

struct EmulationArguments {
  std::string camera = "gige";    ///< one of emulated_cameras()
  std::string sensor = "sc2000";  ///< name or file
  std::string interface_address = "127.0.0.1";
  std::string serial = "TB0001";
  std::vector<std::string> plates{"tcat-a", "tcat-b"};
  double distance_m = 2;
  std::uint16_t black_body_port = 5025, stage_port = 5026;  ///< 0: the system chooses
  double stage_jitter_mm = 0;                               ///< standard deviation of the place while the stage runs
  double black_body_time_constant_s = 0.004;                ///< of its approach to a set-point, > 0
  /// Of a camera after a correction, K/min at first: mean of the picture, standard deviation over the pixels; their
  /// time constant, 0: linear.
  double drift_k_per_min = 0, drift_pattern_k_per_min = 0, drift_time_constant_s = 0;
  bool trigger = true;  ///< the stage tells when a run began in the clock of the camera
  /// A picture in the .npy format, levels from 0 to 1, that a monitor before the camera shows, anew with every change
  /// of the file; black where there is none. Empty: the plates are before the camera.
  std::string monitor_file{};
  double monitor_pixel_mm = 0.25, monitor_span_k = 20, monitor_gamma = 1;  ///< Monitor
  std::uint64_t seed = 1;
  bool operator==(const EmulationArguments&) const = default;
};

/// The laboratory that a plan is measured in: its sensor, plates and distance, on ports that the system chooses.
[[nodiscard]] EmulationArguments emulation_for(const Plan& plan);

#ifdef TODBENCH_WITH_ARAVIS
/// What start_laboratory() starts. Errors: of sensor and plates.
[[nodiscard]] Result<LaboratoryOptions> laboratory_options(const EmulationArguments& arguments);

/// Starts camera, black body and plate stage. Their settling is that of a bench in fast motion: 4 ms time constant and
/// stable after 10 ms, 50 ms per plate or mounting, 1 m/s and 5 ms to come to rest, so that a shift of some millimetres
/// ends within a frame of 20 ms.
[[nodiscard]] Result<std::unique_ptr<Laboratory>> start_laboratory(const EmulationArguments& arguments);

/// The plan with the camera and instruments of a laboratory.
[[nodiscard]] Plan with_laboratory(Plan plan, const Laboratory& laboratory);
#endif

}  // namespace todbench
