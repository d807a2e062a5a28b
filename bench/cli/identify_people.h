// SPDX-License-Identifier: GPL-3.0-or-later
// People in place of the observer of `todbench identify`: their pictures and their answers.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "bench/cli/console.h"
#include "bench/studies/identification_study.h"

namespace todbench {

/// Lives as long as the command.
struct PeopleOptions {
  std::string folder, m75_out;
  std::vector<std::string> answers;
  int per_target = 4;
  void add_to(CLI::App& command);
  [[nodiscard]] bool used() const { return !folder.empty() || !answers.empty(); }
};

/// Writes the pictures, or evaluates the answers. Returns the exit code.
[[nodiscard]] int run_identify_people(Console& console, const PeopleOptions& options,
                                      const IdentificationStudyTask& task);

}  // namespace todbench
