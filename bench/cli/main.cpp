// todbench: the command line.
#include "bench/cli/command_compare_models.h"
#include "bench/cli/command_dynamic.h"
#include "bench/cli/command_enhance.h"
#include "bench/cli/command_identify.h"
#include "bench/cli/command_line.h"
#include "bench/cli/command_module.h"
#include "bench/cli/command_mrtd.h"
#include "bench/cli/command_picture.h"
#include "bench/cli/command_scene_dependence.h"
#include "bench/cli/commands.h"
#include "bench/cli/program.h"

namespace todbench {
namespace {

void add_commands(CLI::App& app, Program& program) {
  add_demo_command(app, program);
  add_devices_command(app, program);
  add_doctor_command(app, program);
  add_emulate_command(app, program);
  add_measure_command(app, program);
  add_simulate_command(app, program);
  add_plan_command(app, program);
  add_cost_command(app, program);
  add_record_command(app, program);
  add_replay_command(app, program);
  add_compare_command(app, program);
  add_report_command(app, program);
  add_verify_command(app, program);
  add_sign_command(app, program);
  add_history_command(app, program);
  add_fit_command(app, program);
  add_render_command(app, program);
  add_mtf_command(app, program);
  add_noise_command(app, program);
  add_pattern_command(app, program);
  add_picture_command(app, program);
  add_identify_command(app, program);
  add_mrtd_command(app, program);
  add_sfr_command(app, program);
  add_sitf_command(app, program);
  add_conformity_command(app, program);
  add_budget_command(app, program);
  add_range_command(app, program);
  add_reproduce_command(app, program);
  add_observer_command(app, program);
  add_reference_set_command(app, program);
  add_sweep_command(app, program);
  add_instrument_command(app, program);
  add_module_command(app, program);
  add_enhance_command(app, program);
  add_compare_models_command(app, program);
  add_scene_dependence_command(app, program);
  add_dynamic_command(app, program);
  add_manual_command(app, program);
}

}  // namespace
}  // namespace todbench

int main(int argc, char** argv) {
  return todbench::run_program(argc, argv, todbench::add_commands);
}
