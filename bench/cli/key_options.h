// SPDX-License-Identifier: GPL-3.0-or-later
// Command-line options that replace values of the plan, generated from the table of plan keys.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

/// Values from the command line: path of the key -> given words. An absent key keeps the value of the plan.
struct KeyOverrides {
  std::map<std::string, std::vector<std::string>, std::less<>> given;

  /// Returns whether a value was given for a key.
  [[nodiscard]] bool has(std::string_view path) const;
};

/// Adds the options of the commands in `of`, except the option of the key with the path `without` (empty: all).
/// `overrides` must outlive the parser.
void add_key_options(CLI::App& command, OptionOf of, KeyOverrides& overrides, std::string_view without = "");

/// Returns the given value. Errors: `invalid_input` "--option: REASON". Precondition: has(path).
[[nodiscard]] Result<KeyValue> given_value(const KeyOverrides& overrides, std::string_view path);
/// Sets the given values in the plan; file names become absolute paths. Errors: those of given_value().
[[nodiscard]] Result<void> apply(const KeyOverrides& overrides, Plan& plan);

/// Replaces the key of the plan in an error by the option, for a user who stated options and no plan.
[[nodiscard]] Error in_terms_of_options(const Error& error);

}  // namespace todbench
