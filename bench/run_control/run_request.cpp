// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run_control/run_request.h"

#include <array>
#include <limits>

#include "acquisition/base/try.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::array all_run_modes{RunMode::measure, RunMode::simulate};
constexpr std::uint64_t largest_seed = std::numeric_limits<std::int64_t>::max();

}  // namespace

std::string_view to_string(RunMode mode) {
  return mode == RunMode::measure ? "measure" : "simulate";
}

Result<RunRequest> parse_run_request(std::string_view body) {
  const Json json = Json::parse(body, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::invalid_input, "the body is not valid JSON");
  const JsonReader reader(json);
  RunRequest request;
  for (const auto& [key, value] : reader.items()) {
    if (key == "plan") {
      request.plan = value.text();
    } else if (key == "plan_toml") {
      request.plan_toml = value.text();
    } else if (key == "mode") {
      request.mode = value.named(all_run_modes);
    } else if (key == "seed") {
      request.seed = value.count();
    } else {
      return fail(ErrorCode::invalid_input,
                  "unknown key '" + one_line(key) + "': known are plan, plan_toml, mode and seed");
    }
  }
  TODBENCH_TRY_VOID(reader.finish());
  if (request.plan.empty() == request.plan_toml.empty())
    return fail(ErrorCode::invalid_input, "expected either plan, a name or file, or plan_toml, the text of a plan");
  if (request.seed > largest_seed) return fail(ErrorCode::invalid_input, "'seed': expected a number below 2^63");
  return request;
}

Result<RequestedRun> requested_run(const RunRequest& request, const std::filesystem::path& folder,
                                   PlanPrograms programs) {
  TODBENCH_TRY(LoadedPlan loaded, request.plan_toml.empty()
                                      ? read_plan(request.plan)
                                      : read_plan(Resource{"plan_toml", request.plan_toml}, folder));
  if (request.seed) {
    Plan plan = loaded.plan();
    plan.seed = *request.seed;
    TODBENCH_TRY(loaded, loaded.with(std::move(plan)));
  }
  const bool starts_programs = !loaded.plan().modules.empty() || !loaded.parts().sensor.modules.empty() ||
                               loaded.plan().target.kind == TargetKind::display;
  if (starts_programs && programs == PlanPrograms::none) {
    return fail(
        ErrorCode::invalid_input,
        "the plan starts programs ([[module]] of the plan or its sensor, or a target of kind display): todbench "
        "serve runs it only with --allow-modules");
  }
  const bool has_camera = !loaded.plan().camera.id.empty();
  const RunMode mode = request.mode.value_or(has_camera ? RunMode::measure : RunMode::simulate);
  if (mode == RunMode::measure && !has_camera)
    return fail(ErrorCode::invalid_input, "the plan has no [camera] id: it can only be simulated");
  return RequestedRun{std::move(loaded), mode};
}

}  // namespace todbench
