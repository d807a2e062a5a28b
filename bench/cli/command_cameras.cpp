// todbench devices, todbench emulate
#include <memory>

#include "acquisition/core/camera_id.h"
#include "bench/cli/commands.h"
#include "bench/run/devices.h"
#include "bench/run/emulation.h"

namespace todbench {
namespace {

int run_devices(Console& console) {
  const auto listing = camera_registry().list();
  for (const auto& warning : listing.warnings) console.note(warning);
  if (console.json()) {
    Json cameras = Json::array();
    for (const auto& c : listing.cameras) {
      cameras.push_back({{"id", c.id},
                         {"vendor", c.vendor},
                         {"model", c.model},
                         {"serial", c.serial},
                         {"transport", c.transport},
                         {"address", c.address}});
    }
    console.object({{"cameras", cameras}, {"warnings", listing.warnings}});
    return 0;
  }
  std::vector<TableRow> rows;
  for (const auto& c : listing.cameras) rows.push_back({c.id, c.vendor, c.model, c.serial, c.transport, c.address});
  console.table({"id", "vendor", "model", "serial", "transport", "address"}, rows);
  return 0;
}

int run_emulate(Console& console, const EmulationArguments& arguments, StopSignals& stop) {
#ifdef TODBENCH_WITH_ARAVIS
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
      console.text("the plan has to state [camera.settings] " + name + " = \"" + value + "\"");
    }
    if (!environment.empty()) {
      console.text("the device node exists for programs that are started with it: " + before_the_command +
                   "todbench measure PLAN.toml");
    }
    console.text("running until Ctrl-C");
  }
  stop.wait();
  return 130;
#else
  (void)arguments;
  (void)stop;
  return report_error(console,
                      {ErrorCode::not_found, "this build has no camera libraries, so nothing can be emulated"});
#endif
}

}  // namespace

void add_devices_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("devices", "lists the cameras that every back end sees");
  finish_command(*command, program, [](Console& console) { return run_devices(console); });
}

void add_emulate_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("emulate", "runs the emulated laboratory until Ctrl-C: camera, black body, plate stage");
  auto a = std::make_shared<EmulationArguments>();
  command->add_option("--camera", a->camera, "interface of the camera")
      ->check(CLI::IsMember(emulated_cameras()))
      ->capture_default_str();
  command->add_option("--sensor", a->sensor, "name or file of the sensor inside the camera")->capture_default_str();
  command->add_option("--interface", a->interface_address, "IPv4 address to serve on")
      ->check(CLI::ValidIPV4)
      ->capture_default_str();
  command->add_option("--serial", a->serial, "serial number of the camera")->capture_default_str();
  command->add_option("--plates", a->plates, "names or files, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command->add_option("--distance-m", a->distance_m, "from camera to plate")
      ->check(number_in(0.1, 1000))
      ->capture_default_str();
  command->add_option("--black-body-port", a->black_body_port, "0: the system chooses")
      ->check(whole_number(0, 65535))
      ->capture_default_str();
  command->add_option("--stage-port", a->stage_port, "0: the system chooses")
      ->check(whole_number(0, 65535))
      ->capture_default_str();
  command->add_option("--stage-jitter-mm", a->stage_jitter_mm, "standard deviation of the place while the stage runs")
      ->check(number_in(0, 10))
      ->capture_default_str();
  command
      ->add_option("--black-body-time-constant-s", a->black_body_time_constant_s,
                   "of the black body's approach to a contrast")
      ->check(number_in(1e-4, 1000))
      ->capture_default_str();
  command->add_option("--drift-k-per-min", a->drift_k_per_min, "of the mean after a correction, at first")
      ->check(number_in(-100, 100))
      ->capture_default_str();
  command
      ->add_option("--drift-pattern-k-per-min", a->drift_pattern_k_per_min,
                   "of the fixed pattern after a correction, standard deviation over the pixels, at first")
      ->check(number_in(0, 100))
      ->capture_default_str();
  command->add_option("--drift-time-constant-s", a->drift_time_constant_s, "of both; 0: they are linear")
      ->check(number_in(0, 1e6))
      ->capture_default_str();
  command->add_flag("!--no-trigger", a->trigger, "the stage does not tell when a run began in the camera's clock");
  command->add_option(
      "--monitor", a->monitor_file,
      "a monitor before the camera that shows the levels of this .npy file, as 'todbench-gui --pictures "
      "--copy' writes it; in place of the plates");
  command->add_option("--monitor-pixel-mm", a->monitor_pixel_mm, "of the monitor, centre to centre")
      ->check(number_in(0.001, 100))
      ->capture_default_str();
  command->add_option("--monitor-span-k", a->monitor_span_k, "contrast of white beside black as the camera sees it")
      ->check(number_in(0.001, 10000))
      ->capture_default_str();
  command->add_option("--monitor-gamma", a->monitor_gamma, "light of the monitor is its level to this power")
      ->check(number_in(0.2, 5))
      ->capture_default_str();
  finish_command(*command, program, [a, &program](Console& console) {
    a->seed = program.common.seed;
    return run_emulate(console, *a, *program.stop);
  });
}

}  // namespace todbench
