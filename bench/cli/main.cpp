// SPDX-License-Identifier: GPL-3.0-or-later
// todbench: the command line.
#include <initializer_list>
#include <string>
#include <vector>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/large_stack.h"
#include "bench/cli/program.h"

namespace todbench {
namespace {

using AddCommand = void (*)(CLI::App&, Program&);

/// Adds commands under one heading of the help. Commands below them keep the heading of the parser.
void add_group(CLI::App& app, Program& program, const std::string& heading,
               std::initializer_list<AddCommand> commands) {
  const std::size_t first = app.get_subcommands({}).size();
  for (const AddCommand add : commands) add(app, program);
  const std::vector<CLI::App*> all = app.get_subcommands({});
  for (std::size_t i = first; i < all.size(); ++i) all[i]->group(heading);
}

void add_commands(CLI::App& app, Program& program) {
  add_group(app, program, "Measure",
            {add_demo_command, add_devices_command, add_doctor_command, add_emulate_command, add_measure_command,
             add_record_command, add_replay_command, add_judge_command, add_blind_command, add_serve_command});
  add_group(app, program, "Simulate and plan",
            {add_simulate_command, add_plan_command, add_cost_command, add_render_command, add_mtf_command,
             add_plate_command});
  add_group(app, program, "Judge, report and sign",
            {add_compare_command, add_report_command, add_verify_command, add_sign_command, add_conformity_command,
             add_budget_command, add_certificate_command});
  add_group(app, program, "Single measures",
            {add_fit_command, add_noise_command, add_sfr_command, add_sitf_command, add_mrtd_command,
             add_dynamic_command, add_pattern_command, add_watch_command});
  add_group(app, program, "Field", {add_range_command, add_identify_command, add_picture_command});
  add_group(app, program, "Studies",
            {add_sweep_command, add_enhance_command, add_compare_models_command, add_scene_dependence_command,
             add_observer_command, add_reference_set_command, add_round_robin_command, add_reproduce_command});
  add_group(app, program, "Maintenance",
            {add_selftest_command, add_history_command, add_instrument_command, add_module_command});
  add_manual_command(app, program);
}

}  // namespace
}  // namespace todbench

int main(int argc, char** argv) {
  return todbench::on_a_large_stack([&] { return todbench::run_program(argc, argv, todbench::add_commands); });
}
