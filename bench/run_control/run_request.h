// SPDX-License-Identifier: GPL-3.0-or-later
// Run that a client requests: a plan, and whether to measure or to simulate it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {

/// Kind of a run.
enum class RunMode {
  measure,   ///< as `todbench measure`
  simulate,  ///< as `todbench simulate`
};
/// Returns "measure" or "simulate".
[[nodiscard]] std::string_view to_string(RunMode mode);

/// Request for a run.
struct RunRequest {
  std::string plan{};             ///< name or file of this computer; empty if `plan_toml` is given
  std::string plan_toml{};        ///< text of a plan
  std::optional<RunMode> mode{};  ///< empty: measure if the plan names a camera
  std::optional<std::uint64_t> seed{};
};

/// Parses {"plan" or "plan_toml", "mode", "seed"}. Errors: `invalid_input` (not such an object, unknown key).
[[nodiscard]] Result<RunRequest> parse_run_request(std::string_view body);

/// Programs that a plan may start.
enum class PlanPrograms {
  none,
  modules,  ///< programs of [[module]] in the plan or its sensor, and of a target of kind display
};

/// Run with its loaded plan.
struct RequestedRun {
  LoadedPlan plan;
  RunMode mode = RunMode::measure;
};

/// Reads the plan in the same way as the command line. File names in the text of a plan are relative to `folder`.
/// Errors: `invalid_input` about the plan, also for a plan that starts programs with PlanPrograms::none.
[[nodiscard]] Result<RequestedRun> requested_run(const RunRequest& request, const std::filesystem::path& folder,
                                                 PlanPrograms programs);

}  // namespace todbench
