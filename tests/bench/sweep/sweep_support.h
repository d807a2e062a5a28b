// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps that tests expand, and tables as `collect` makes them.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/sweep/sweep.h"
#include "bench/sweep/sweep_table.h"
#include "bench/text/text.h"

namespace todbench::testing_support {

/// Finds no file.
inline std::optional<double> nobody(std::string_view) {
  return std::nullopt;
}

inline Sweep expanded(const std::string& text) {
  auto file = parse_sweep(text, "/tmp/a.toml");
  EXPECT_TRUE(file) << file.error().message;
  auto sweep = Sweep::expand(*file, "", nobody);
  EXPECT_TRUE(sweep) << sweep.error().message;
  return *sweep;
}

/// Of one task, in the order of the keys.
inline std::vector<std::string> values_of(const Sweep& sweep, std::size_t index) {
  std::vector<std::string> values;
  for (const auto& parameter : sweep.task(index).parameters) values.push_back(parameter.value);
  return values;
}

using Response = std::function<double(const std::vector<double>& x, std::size_t index)>;

/// What `collect` makes of results that are this function.
inline SweepTable table_of(const Sweep& sweep, const Response& response) {
  SweepTable table;
  table.columns = sweep.keys();
  table.columns.insert(table.columns.begin(), "index");
  table.columns.insert(table.columns.end(), {"repeat", "y"});
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    Json row = {i};
    std::vector<double> x;
    for (const auto& value : values_of(sweep, i)) x.push_back(*parse_number(value));
    for (const double value : x) row.push_back(value);
    row.push_back(sweep.task(i).repeat);
    row.push_back(response(x, i));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// What is said where a sweep is refused; empty where it is not.
inline std::string refusal(const std::string& text) {
  const auto file = parse_sweep(text, "a.toml");
  if (!file) return file.error().message;
  const auto sweep = Sweep::expand(*file, "", nobody);
  return sweep ? "" : sweep.error().message;
}

}  // namespace todbench::testing_support
