// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/module_plan.h"

#include <nlohmann/json.hpp>

#include "acquisition/base/safe_text.h"

namespace todbench {

std::string_view to_string(ModulePlace place) {
  constexpr std::string_view names[] = {"picture", "observer", "sensor"};
  return names[static_cast<std::size_t>(place)];
}

ModuleStageOptions stage_options(const ModulePlan& plan, std::span<const SensorFact> sensor) {
  nlohmann::json parameters = nlohmann::json::object();
  for (const auto& [key, value] : plan.parameters) parameters[key] = value;
  nlohmann::json header{{"protocol", "todbench-module"},
                        {"version", 1},
                        {"place", std::string(to_string(plan.place))},
                        {"parameters", parameters}};
  for (const auto& [name, value] : sensor)
    std::visit([&, &key = name](auto number) { header["sensor"][key] = number; }, value);
  ModuleStageOptions options;
  options.process.command = plan.command;
  // Invalid UTF-8 is replaced, because an exception would end the run.
  options.process.header = header.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  options.process.limit = std::chrono::milliseconds(plan.limit_ms);
  options.process.memory_limit_mib = static_cast<std::size_t>(plan.memory_mib);
  options.process.network = plan.network ? ModuleNetwork::ours : ModuleNetwork::cut;
  options.restart_frames = plan.restart_frames;
  options.settle_frames = plan.settle_frames;
  return options;
}

Error module_error(const ModulePlan& plan, const Error& error) {
  const ErrorCode code = error.code == ErrorCode::internal ? ErrorCode::internal : ErrorCode::integrity;
  return {code, "module '" + one_line(plan.command) + "': " + error.message};
}

}  // namespace todbench
