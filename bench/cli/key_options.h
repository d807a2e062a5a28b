// Options that stand in place of keys of the plan, from the table of keys.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

/// What the command line says in place of keys: path of the key -> the words given. Not there: the plan's own value.
struct KeyOverrides {
  std::map<std::string, std::vector<std::string>, std::less<>> given;

  [[nodiscard]] bool has(std::string_view path) const;
};

/// Adds the options of the commands `of`, but for that of the key `without` (a path; empty: all). `overrides` outlives
/// the parser.
void add_key_options(CLI::App& command, OptionOf of, KeyOverrides& overrides, std::string_view without = "");

/// The value that was given; `invalid_input` "--option: REASON". Precondition: has(path).
[[nodiscard]] Result<KeyValue> given_value(const KeyOverrides& overrides, std::string_view path);
/// Puts what was given into the plan, files as absolute paths. Errors: as given_value().
[[nodiscard]] Result<void> apply(const KeyOverrides& overrides, Plan& plan);

/// An error about a key of the plan, said to somebody who wrote options and no plan.
[[nodiscard]] Error in_terms_of_options(const Error& error);

}  // namespace todbench
