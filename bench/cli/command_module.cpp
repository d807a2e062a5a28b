// SPDX-License-Identifier: GPL-3.0-or-later
// todbench module
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <memory>

#include "bench/plan/descriptions.h"
#include "sim_devices/module/module_check.h"
#include "sim_devices/module/module_observer_check.h"
#include "sim_devices/sensor/module_sensor_check.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

struct ModuleArguments {
  std::string command;
  int limit_ms = 5000;
  std::size_t memory_mib = 0;
  bool network = false;
  std::string place = "picture", observer = "hvs-1";
};

Json report_json(const ModuleReport& report) {
  Json shapes = Json::array(), response = Json::array();
  for (const auto& shape : report.shapes) shapes.push_back({shape.height, shape.width});
  for (int j = 0; j < report.impulse_response.rows; ++j) {
    Json row = Json::array();
    for (int i = 0; i < report.impulse_response.cols; ++i)
      row.push_back(json_number(static_cast<double>(report.impulse_response(j, i))));
    response.push_back(std::move(row));
  }
  return {{"ok", true},
          {"deterministic", true},
          {"shapes", shapes},
          {"network_cut", report.network_cut},
          {"latency_ms", json_number(report.latency_ms)},
          {"linear", report.linear},
          {"linearity_deviation", json_number(report.linearity_deviation)},
          {"impulse_sum", json_number(report.impulse_sum)},
          {"impulse_response", response},
          {"reason", nullptr}};
}

int refuse_module(Console& console, const Error& error) {
  if (console.json()) console.object({{"ok", false}, {"reason", error.message}});
  return report_error(console, error);
}

ModulePlan planned(const ModuleArguments& a, ModulePlace place) {
  return {.place = place,
          .command = a.command,
          .version = {},
          .parameters = {},
          .limit_ms = a.limit_ms,
          .memory_mib = static_cast<int>(a.memory_mib),
          .network = a.network};
}

std::string said_of_network(bool cut) {
  return cut ? "the module had no network" : "the module had the network of this host";
}

int run_observer_check(Console& console, const ModuleArguments& a) {
  const auto spec = load_observer(a.observer);
  if (!spec) return report_error(console, spec.error());
  const auto report = check_observer(*spec, triangle_alternatives(), planned(a, ModulePlace::observer));
  if (!report) return refuse_module(console, report.error());
  if (console.json()) {
    Json sizes = Json::array();
    for (const JudgedSize& size : report->sizes) {
      sizes.push_back({{"size_samples", size.size_samples},
                       {"samples_per_pitch", size.samples_per_pitch},
                       {"window_samples", size.window_samples},
                       {"asked", size.asked},
                       {"right", size.right}});
    }
    console.object({{"ok", true},
                    {"deterministic", true},
                    {"sizes", sizes},
                    {"order_matters", report->order_matters},
                    {"network_cut", report->network_cut},
                    {"latency_ms", json_number(report->latency_ms)},
                    {"reason", nullptr}});
    return 0;
  }
  console.text("keeps the contract of an observer: one score per alternative, two processes agree bit for bit");
  console.text(said_of_network(report->network_cut));
  console.text(fmt::format("{:.3f} ms per target of 5 samples", report->latency_ms));
  std::vector<TableRow> rows;
  for (const JudgedSize& size : report->sizes) {
    rows.push_back({fmt::format("{:g}", size.size_samples), std::to_string(size.samples_per_pitch),
                    fmt::format("{} x {}", size.window_samples, size.window_samples),
                    fmt::format("{} of {}", size.right, size.asked)});
  }
  console.table({"size (samples)", "samples/pitch", "patch", "correct without sensor noise"}, rows);
  if (report->order_matters) console.note("the scores of a patch depend on the patches before it");
  return 0;
}

int run_sensor_check(Console& console, const ModuleArguments& a) {
  SensorSpec spec;
  spec.modules = {planned(a, ModulePlace::sensor)};
  const auto report = check_sensor(spec);
  if (!report) return refuse_module(console, report.error());
  if (console.json()) {
    Json shapes = Json::array();
    for (const auto& shape : report->shapes) shapes.push_back({shape.height, shape.width});
    console.object({{"ok", true},
                    {"deterministic", true},
                    {"shapes", shapes},
                    {"network_cut", report->network_cut},
                    {"latency_ms", json_number(report->latency_ms)},
                    {"linear", report->linear},
                    {"linearity_deviation", json_number(report->linearity_deviation)},
                    {"response", json_number(report->response)},
                    {"noise_k", json_number(report->noise_k)},
                    {"reason", nullptr}});
    return 0;
  }
  console.text(fmt::format("keeps the contract of a sensor: frames of {} sizes, two processes agree bit for bit",
                           report->shapes.size()));
  console.text(said_of_network(report->network_cut));
  console.text(fmt::format("{:.3f} ms per frame of 320 x 240 pixels", report->latency_ms));
  console.text(fmt::format("{}, deviation {:.2g}; response to a scene of 1 K: {:.4g} K, temporal noise {:.3g} K",
                           report->linear ? "linear" : "not linear", report->linearity_deviation, report->response,
                           report->noise_k));
  return 0;
}

int run_check(Console& console, const ModuleArguments& a) {
  if (a.place == to_string(ModulePlace::sensor)) return run_sensor_check(console, a);
  if (a.place == to_string(ModulePlace::observer)) return run_observer_check(console, a);
  const auto report =
      check_module({.command = a.command,
                    .header = R"({"protocol": "todbench-module", "version": 1, "place": "picture", "parameters": {}})",
                    .limit = std::chrono::milliseconds(a.limit_ms),
                    .memory_limit_mib = a.memory_mib,
                    .network = a.network ? ModuleNetwork::ours : ModuleNetwork::cut});
  if (!report) return refuse_module(console, report.error());
  if (console.json()) {
    console.object(report_json(*report));
    return 0;
  }
  console.text(
      fmt::format("keeps the contract: {} shapes processed, two processes agree bit for bit", report->shapes.size()));
  console.text(said_of_network(report->network_cut));
  console.text(fmt::format("{:.3f} ms per exchange of 320 x 240 numbers", report->latency_ms));
  console.text(fmt::format("{}, deviation {:.2g}; impulse response: sum {:.4g}, centre {:.4g}",
                           report->linear ? "linear" : "not linear", report->linearity_deviation, report->impulse_sum,
                           report->impulse_response(4, 4)));
  return 0;
}

}  // namespace

void add_module_command(CLI::App& app, Program& program) {
  auto* module = app.add_subcommand("module", "tests programs of the user that are stages of the chain");
  module->require_subcommand(1);
  auto* check = module->add_subcommand(
      "check", "tests whether a program keeps the contract of a module, and reports its properties");
  auto a = std::make_shared<ModuleArguments>();
  check->add_option("COMMAND", a->command, "command for a shell, in quotes")->required();
  check->add_option("--limit-ms", a->limit_ms, "longest time for an answer in ms")
      ->check(whole_number(1, 600000))
      ->capture_default_str();
  check
      ->add_option("--memory-mib", a->memory_mib,
                   "largest address space of each process of the module in MiB; 0: no limit")
      ->check(whole_number(0, 1 << 20))
      ->capture_default_str();
  check
      ->add_option(
          "--place", a->place,
          "place in the chain: picture (picture to picture), sensor (scene to frame) or observer (patch to scores)")
      ->check(CLI::IsMember({std::string(to_string(ModulePlace::picture)), std::string(to_string(ModulePlace::sensor)),
                             std::string(to_string(ModulePlace::observer))}))
      ->capture_default_str();
  check
      ->add_option("--observer", a->observer,
                   "observer whose window and internal noise the patches have, for the place observer")
      ->capture_default_str();
  check->add_flag("--network", a->network, "gives the module access to the network of this host");
  finish_command(*check, program, [a](Console& console) { return run_check(console, *a); });
}

}  // namespace todbench
