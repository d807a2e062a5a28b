// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommands of the program. Each subcommand adds itself to the parser and sets the action that returns its exit code.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>

#include "bench/cli/console.h"
#include "bench/cli/stop_signals.h"

namespace todbench {

/// Options of every subcommand.
struct CommonOptions {
  ConsoleOptions console;
  std::uint64_t seed = 1;
  /// True if --seed was stated.
  bool seed_given = false;
};

/// State shared by the parser and the commands.
struct Program {
  CommonOptions common;
  StopSignals* stop = nullptr;  ///< must outlive the run
  std::function<int()> chosen;  ///< set by the chosen subcommand
};

/// Adds --json, --quiet and --seed, and sets `action` to run when the subcommand is chosen.
void finish_command(CLI::App& command, Program& program, std::function<int(Console&)> action);

/// Return validators of option values from `low` to `high`, both included. Unlike the validators of the parser, these
/// validators reject NaN and quote the value. If the value would be valid in a different unit, the message names that
/// unit. `unit`: unit of the option, as in the suffix of its name.
[[nodiscard]] CLI::Validator number_in(double low, double high, std::string_view unit = {});
[[nodiscard]] CLI::Validator whole_number(std::int64_t low, std::int64_t high);

/// Prints the error and returns its exit code.
[[nodiscard]] int report_error(Console& console, const Error& error);

/// Add the subcommand that the function names to `app`.
void add_fit_command(CLI::App& app, Program& program);
void add_render_command(CLI::App& app, Program& program);
void add_mtf_command(CLI::App& app, Program& program);
void add_devices_command(CLI::App& app, Program& program);
void add_doctor_command(CLI::App& app, Program& program);
void add_emulate_command(CLI::App& app, Program& program);
void add_demo_command(CLI::App& app, Program& program);
void add_measure_command(CLI::App& app, Program& program);
void add_plan_command(CLI::App& app, Program& program);
void add_cost_command(CLI::App& app, Program& program);
void add_simulate_command(CLI::App& app, Program& program);
void add_record_command(CLI::App& app, Program& program);
void add_replay_command(CLI::App& app, Program& program);
void add_compare_command(CLI::App& app, Program& program);
void add_report_command(CLI::App& app, Program& program);
void add_verify_command(CLI::App& app, Program& program);
void add_history_command(CLI::App& app, Program& program);
void add_sign_command(CLI::App& app, Program& program);
void add_noise_command(CLI::App& app, Program& program);
void add_pattern_command(CLI::App& app, Program& program);
void add_range_command(CLI::App& app, Program& program);
void add_sfr_command(CLI::App& app, Program& program);
void add_sitf_command(CLI::App& app, Program& program);
void add_conformity_command(CLI::App& app, Program& program);
void add_budget_command(CLI::App& app, Program& program);
void add_reference_set_command(CLI::App& app, Program& program);
void add_observer_command(CLI::App& app, Program& program);
void add_round_robin_command(CLI::App& app, Program& program);
void add_reproduce_command(CLI::App& app, Program& program);
void add_selftest_command(CLI::App& app, Program& program);
void add_serve_command(CLI::App& app, Program& program);
void add_sweep_command(CLI::App& app, Program& program);
void add_instrument_command(CLI::App& app, Program& program);
void add_blind_command(CLI::App& app, Program& program);
void add_certificate_command(CLI::App& app, Program& program);
void add_compare_models_command(CLI::App& app, Program& program);
void add_dynamic_command(CLI::App& app, Program& program);
void add_enhance_command(CLI::App& app, Program& program);
void add_identify_command(CLI::App& app, Program& program);
void add_judge_command(CLI::App& app, Program& program);
void add_module_command(CLI::App& app, Program& program);
void add_mrtd_command(CLI::App& app, Program& program);
void add_picture_command(CLI::App& app, Program& program);
void add_plate_command(CLI::App& app, Program& program);
void add_scene_dependence_command(CLI::App& app, Program& program);
void add_watch_command(CLI::App& app, Program& program);
/// Adds "naked-eye" to the command `observer`.
void add_naked_eye_command(CLI::App& observer, Program& program);

}  // namespace todbench
