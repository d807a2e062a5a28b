// SPDX-License-Identifier: GPL-3.0-or-later
// todbench devices, todbench emulate
#include <memory>

#include "acquisition/core/camera_id.h"
#include "bench/cli/commands.h"
#include "bench/devices/devices.h"
#include "bench/devices/emulation.h"
#include "bench/run_control/control_api.h"

namespace todbench {
namespace {

int run_devices(Console& console) {
  const auto listing = camera_registry().list();
  for (const auto& warning : listing.warnings) console.note(warning);
  if (console.json()) {
    console.object(cameras_json(listing));
    return 0;
  }
  std::vector<TableRow> rows;
  for (const auto& c : listing.cameras) rows.push_back({c.id, c.vendor, c.model, c.serial, c.transport, c.address});
  console.table({"id", "vendor", "model", "serial", "transport", "address"}, rows);
  return 0;
}

int run_emulate(Console& console, const EmulationArguments& arguments, StopSignals& stop) {
#ifdef TODBENCH_WITH_ARAVIS
  stop.observe();
  auto laboratory = start_laboratory(arguments);
  if (!laboratory) return report_error(console, laboratory.error());
  const Laboratory& lab = **laboratory;
  if (console.json()) {
    console.object({{"camera",
                     {{"id", lab.camera_id()},
                      {"address", lab.camera_address()},
                      {"settings", lab.camera_settings()},
                      {"environment", lab.client_environment()}}},
                    {"black_body", lab.black_body_endpoint()},
                    {"stage", lab.stage_endpoint()}});
  } else {
    const auto environment = lab.client_environment();
    const std::string by_address =
        environment.empty() ? " or \"" + camera_id(camera_scheme::gige, lab.camera_address()) + "\"" : "";
    console.table(
        {"device", "address", "for the plan"},
        {{"camera", lab.camera_address(), "[camera] id = \"" + lab.camera_id() + "\"" + by_address},
         {"black body", lab.black_body_endpoint(), "[target] black_body = \"" + lab.black_body_endpoint() + "\""},
         {"plate stage", lab.stage_endpoint(), "[target] stage = \"" + lab.stage_endpoint() + "\""}});
    std::string before_the_command;
    for (const auto& [name, value] : environment) before_the_command += name + "=" + value + " ";
    for (const auto& [name, value] : lab.camera_settings()) {
      console.text("the plan must state [camera.settings] " + name + " = \"" + value + "\"");
    }
    if (!environment.empty()) {
      console.text("the device node exists only for programs started with this environment: " + before_the_command +
                   "todbench measure PLAN.toml");
    }
    console.text("running until Ctrl-C");
  }
  stop.wait();
  return 130;
#else
  (void)arguments;
  (void)stop;
  return report_error(
      console, {ErrorCode::not_found,
                "this build has no camera libraries and cannot emulate the laboratory; build todbench with Aravis"});
#endif
}

}  // namespace

void add_devices_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("devices", "lists the cameras that each back end finds");
  finish_command(*command, program, [](Console& console) { return run_devices(console); });
}

void add_emulate_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("emulate", "runs the emulated laboratory until Ctrl-C: camera, black body, plate stage");
  auto a = std::make_shared<EmulationArguments>();
  command->add_option("--camera", a->camera, "interface of the emulated camera")
      ->check(CLI::IsMember(emulated_cameras()))
      ->capture_default_str();
  command->add_option("--sensor", a->sensor, "sensor of the emulated camera: name or file")->capture_default_str();
  command
      ->add_option("--interface", a->interface_address,
                   "IPv4 address on which the camera and the instruments are served")
      ->check(CLI::ValidIPV4)
      ->capture_default_str();
  command->add_option("--serial", a->serial, "serial number of the camera")->capture_default_str();
  command->add_option("--plates", a->plates, "plates of the laboratory: names or files, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command->add_option("--distance-m", a->distance_m, "distance from the camera to the plate in m")
      ->check(number_in(0.1, 1000, "m"))
      ->capture_default_str();
  command
      ->add_option("--collimator-transmission", a->collimator_transmission,
                   "transmission of a collimator before the plate; the distance is then its focal length")
      ->check(number_in(0.01, 1))
      ->capture_default_str();
  command->add_option("--collimator-mirror-c", a->collimator_mirror_c, "temperature of its mirrors in degrees Celsius")
      ->check(number_in(-100, 200, "c"))
      ->capture_default_str();
  command
      ->add_option("--collimator-blur-mrad", a->collimator_blur_mrad,
                   "aberration of the collimator: standard deviation of its blur in mrad")
      ->check(number_in(0, 100, "mrad"))
      ->capture_default_str();
  command->add_option("--latency-ms", a->latency_ms, "delay in ms from the exposure of a frame to its time stamp")
      ->check(number_in(0, 10000, "ms"))
      ->capture_default_str();
  command->add_flag("--black-body-celsius", a->celsius,
                    "the black body answers absolute temperatures in degrees Celsius, against its command table");
  command->add_option("--black-body-port", a->black_body_port, "TCP port of the black body; 0: any free port")
      ->check(whole_number(0, 65535))
      ->capture_default_str();
  command->add_option("--stage-port", a->stage_port, "TCP port of the plate stage; 0: any free port")
      ->check(whole_number(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--stage-jitter-mm", a->stage_jitter_mm,
                   "random displacement of the plate during a run of the stage: standard deviation in mm")
      ->check(number_in(0, 10, "mm"))
      ->capture_default_str();
  command
      ->add_option("--black-body-time-constant-s", a->black_body_time_constant_s,
                   "time constant in s with which the black body approaches a new contrast")
      ->check(number_in(1e-4, 1000, "s"))
      ->capture_default_str();
  command
      ->add_option("--drift-k-per-min", a->drift_k_per_min,
                   "initial drift of the mean after a correction (NUC), in K/min")
      ->check(number_in(-100, 100))
      ->capture_default_str();
  command
      ->add_option(
          "--drift-pattern-k-per-min", a->drift_pattern_k_per_min,
          "initial growth of the fixed pattern after a correction (NUC), in K/min; standard deviation over the pixels")
      ->check(number_in(0, 100))
      ->capture_default_str();
  command
      ->add_option("--drift-time-constant-s", a->drift_time_constant_s,
                   "time constant of both drifts in s; 0: the drifts are linear")
      ->check(number_in(0, 1e6, "s"))
      ->capture_default_str();
  command->add_flag("!--no-trigger", a->trigger,
                    "the stage does not report when a run began in the clock of the camera");
  command->add_option("--monitor", a->monitor_file,
                      "shows the levels of this .npy file on a monitor in front of the camera, instead of the plates; "
                      "'todbench-gui --pictures --copy' writes such a file");
  command->add_option("--monitor-pixel-mm", a->monitor_pixel_mm, "pixel pitch of the monitor in mm")
      ->check(number_in(0.001, 100, "mm"))
      ->capture_default_str();
  command
      ->add_option("--monitor-span-k", a->monitor_span_k,
                   "observed contrast between white and black of the monitor, in K")
      ->check(number_in(0.001, 10000, "k"))
      ->capture_default_str();
  command->add_option("--monitor-gamma", a->monitor_gamma, "gamma of the monitor: its light is the level to this power")
      ->check(number_in(0.2, 5))
      ->capture_default_str();
  finish_command(*command, program, [a, &program](Console& console) {
    a->seed = program.common.seed;
    return run_emulate(console, *a, *program.stop);
  });
}

}  // namespace todbench
