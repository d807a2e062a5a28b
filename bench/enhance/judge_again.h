// SPDX-License-Identifier: GPL-3.0-or-later
// Second judgement of the recorded frames of a session, by a different observer or through an enhancement package.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "bench/enhance/package_file.h"
#include "bench/run/experiment.h"
#include "bench/run/replay.h"

namespace todbench {

/// Observer, package and display of the new judgement. An empty member keeps the choice of the session.
struct JudgeRequest {
  std::string observer{};                       ///< name or file
  std::optional<EnhancementPackage> package{};  ///< package applied to the pictures of the camera and of its twin
  std::optional<ViewedDisplay> display{};       ///< display for an observer with an eye
};

/// Runs the plan of the session on its recorded frames, simulates the twin, compares and judges. Writes a new session
/// that names its origin. The same observer without a package gives the same trials and the same curve. With a package,
/// the answers are binary and are fitted with a Weibull function, because the psychometric functions of the sensor do
/// not include the package. Manifest and signature of the session are verified first. Errors: those of
/// open_recorded_run() and measure_on_bench(); `invalid_input` (adaptive schedule, because its frames depend on the
/// answers; grey levels with a package; no display although the observer requires one; invalid signature);
/// `not_found` if the program that verifies the signature is missing.
[[nodiscard]] Result<ExperimentOutcome> judge_again(const std::filesystem::path& session, const JudgeRequest& request,
                                                    ExperimentOptions options, const ExperimentListener& listener,
                                                    std::stop_token stop, const Opening& opening = {},
                                                    RunModules modules = RunModules::no);

}  // namespace todbench
