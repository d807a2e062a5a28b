// SPDX-License-Identifier: GPL-3.0-or-later
// People in place of the observer of `todbench identify`: their pictures and their answers.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "bench/cli/console.h"
#include "bench/studies/identification_study.h"
#include "bench/text/json.h"

namespace todbench {

/// Lives as long as the command.
struct PeopleOptions {
  std::string folder, m75_out;
  std::vector<std::string> answers;
  int per_target = 4;
  void add_to(CLI::App& command);
  [[nodiscard]] bool used() const { return !folder.empty() || !answers.empty(); }
};

/// Range of 75 % correct in words, or why there is none.
[[nodiscard]] std::string range_text(const SetCriterion& r75_m, std::string_view none_because);
/// M75 and V50 of a set in words, or why there are none.
[[nodiscard]] std::string criteria_text(const IdentificationStudy& study);
/// M75 or V50 as JSON.
[[nodiscard]] Json criterion_json(const SetCriterion& criterion, const std::string& none_because);

/// Writes the pictures, or evaluates the answers. Returns the exit code.
[[nodiscard]] int run_identify_people(Console& console, const PeopleOptions& options,
                                      const IdentificationStudyTask& task);

}  // namespace todbench
