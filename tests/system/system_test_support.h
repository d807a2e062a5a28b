// SPDX-License-Identifier: GPL-3.0-or-later
// What the system tests share: plans that run in a second or two, and what holds for every output of the program.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/system/child_process.h"

namespace todbench::testing {

using Json = nlohmann::json;

/// A plan of one plate at one contrast in draft accuracy, to be simulated within a second: without a `[fit]` in `more`
/// with a Weibull function, because that of the twin costs as much again. `more` is added at its end.
[[nodiscard]] std::string small_plan(int phases, const std::string& more = "");
/// File of the SC2000 with a pitch of 60 um along y and this side of the detectors along y.
[[nodiscard]] std::string tall_sensor(double detector_y_um);
/// The same, measured with the simulated camera.
[[nodiscard]] std::string small_measurement(int phases, const std::string& more = "");

/// Parses standard output as one JSON object on one line; fails the test when it is anything else or holds a number
/// that is none.
[[nodiscard]] Json one_object(const Ended& ended);
[[nodiscard]] std::set<std::string> keys_of(const Json& object);
/// Fails the test unless the program ended with `code` and its last line of standard error is one sentence that holds
/// `sentence`, nothing on standard output.
void expect_refused(const Ended& ended, int code, const std::string& sentence);
[[nodiscard]] std::vector<std::string> lines_of(const std::string& text);
/// The run came to its end: every limit met, one missed, or not decided.
[[nodiscard]] ::testing::AssertionResult completed(const Ended& ended);
/// The two files have the same bytes; tells the first line that differs.
[[nodiscard]] ::testing::AssertionResult same_content(const std::filesystem::path& a, const std::filesystem::path& b);
/// Returns the decision on each effect by the name of the effect, from a JSON list of effects.
[[nodiscard]] std::map<std::string, std::string> decisions_of(const Json& effects);
/// How often `of` stands in `text`; overlapping ones count.
[[nodiscard]] int occurrences(const std::string& text, const std::string& of);
/// Data rows of a CSV file; 0 when it is not there.
[[nodiscard]] std::size_t rows_in(const std::filesystem::path& csv);
/// The files that every session has, the manifest agrees with all of them.
void expect_whole_session(const std::filesystem::path& folder, const std::string& state);

}  // namespace todbench::testing
