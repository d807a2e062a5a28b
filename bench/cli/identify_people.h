// SPDX-License-Identifier: GPL-3.0-or-later
// Options of `todbench identify` for people in place of the observer: writing the pictures, and evaluating the answers.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "bench/cli/console.h"
#include "bench/studies/identification_study.h"
#include "bench/text/json.h"

namespace todbench {

/// Options for people. They must outlive the parser.
struct PeopleOptions {
  std::string folder,  ///< new folder for pictures in random order, with the truth in a separate folder; empty: none
      m75_out;         ///< file for the M75 of the people (RangeTask::m75), for `todbench range --m75-of`; empty: none
  /// Paths of answers.csv files, one per person. The pictures must have been written with the same options and seed.
  std::vector<std::string> answers;
  /// Number of pictures of each target at each range for one person.
  int per_target = 4;
  /// Adds the options to a command.
  void add_to(CLI::App& command);
  /// Returns whether people replace the observer.
  [[nodiscard]] bool used() const { return !folder.empty() || !answers.empty(); }
};

/// Returns the range with 75 % correct answers in words; without a range, a phrase with the reason `none_because`.
[[nodiscard]] std::string range_text(const SetCriterion& r75_m, std::string_view none_because);
/// Returns M75 and V50 of a set in words, or the reason for their absence.
[[nodiscard]] std::string criteria_text(const IdentificationStudy& study);
/// Returns M75 or V50 as JSON.
[[nodiscard]] Json criterion_json(const SetCriterion& criterion, const std::string& none_because);

/// Writes the pictures, or evaluates the answers. Returns the exit code.
[[nodiscard]] int run_identify_people(Console& console, const PeopleOptions& options,
                                      const IdentificationStudyTask& task);

}  // namespace todbench
