// SPDX-License-Identifier: GPL-3.0-or-later
// todbench doctor
#include <algorithm>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/doctor/doctor.h"

namespace todbench {
namespace {

struct DoctorArguments {
  std::string root = "/", folder = ".";
  DoctorDemand demand;
};

/// Returns 0 if no problem prevents a run, otherwise 1.
int run_doctor(Console& console, const DoctorArguments& arguments) {
  SystemFacts facts = live_facts(arguments.folder);
  // The firewall rules of this system do not apply to another root.
  if (arguments.root != "/") facts.firewall_rules.reset();
  const auto checks = examine(arguments.root, facts, arguments.demand);
  const bool trouble =
      std::any_of(checks.begin(), checks.end(), [](const auto& c) { return c.finding == Finding::problem; });
  if (console.json()) {
    Json list = Json::array();
    for (const auto& c : checks) {
      list.push_back({{"name", c.name},
                      {"finding", to_string(c.finding)},
                      {"found", c.found},
                      {"explanation", c.explanation},
                      {"command", c.command.empty() ? Json() : Json(c.command)}});
    }
    console.object({{"checks", list}, {"verdict", trouble ? "problem" : "ok"}});
    return trouble ? 1 : 0;
  }
  std::vector<TableRow> rows;
  for (const auto& c : checks) rows.push_back({c.name, std::string(to_string(c.finding)), c.found});
  console.table({"check", "finding", "found"}, rows);
  for (const auto& c : checks) {
    if (c.finding == Finding::ok) continue;
    console.text("");
    console.text(c.name + ": " + c.explanation);
    if (!c.command.empty()) console.text("  repair with: " + c.command);
  }
  return trouble ? 1 : 0;
}

}  // namespace

void add_doctor_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("doctor", "checks the computer for common faults and prints the command that repairs each");
  auto a = std::make_shared<DoctorArguments>();
  command->add_option("--folder", a->folder, "folder in which sessions will be written")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  command->add_option("--frame-bytes", a->demand.frame_bytes, "size of one frame in bytes")
      ->check(whole_number(1, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--frame-rate-hz", a->demand.frame_rate_hz, "frame rate of the camera in Hz")
      ->check(number_in(0.1, 10000))
      ->capture_default_str();
  command
      ->add_option("--packet-bytes", a->demand.packet_bytes,
                   "size of a GigE Vision packet in bytes, with its IP and UDP headers")
      ->check(whole_number(576, 65535))
      ->capture_default_str();
  command
      ->add_option("--recording-minutes", a->demand.recording_minutes,
                   "duration of the recording to be stored on disk, in minutes")
      ->check(number_in(0, 100000))
      ->capture_default_str();
  command->add_option("--root", a->root, "reads the system files below this folder")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  finish_command(*command, program, [a](Console& console) { return run_doctor(console, *a); });
}

}  // namespace todbench
