// SPDX-License-Identifier: GPL-3.0-or-later
// todbench selftest
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/selftest/selftest.h"
#include "bench/session/build_info.h"
#include "bench/session/json_output.h"
#include "bench/session/selftest_record.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr int a_case_failed = 7;

std::string number(double value) {
  return fmt::format("{:.9g}", value);
}

Json selftest_json(const std::vector<SelftestCase>& cases, std::ptrdiff_t failed) {
  Json list = Json::array();
  for (const SelftestCase& one : cases) {
    list.push_back({{"group", one.group},
                    {"name", one.name},
                    {"value", json_number(one.value)},
                    {"expected", json_number(one.expected)},
                    {"tolerance", json_number(one.tolerance)},
                    {"ok", one.ok()}});
  }
  return {{"passed", static_cast<std::ptrdiff_t>(cases.size()) - failed},
          {"failed", failed},
          {"version", build_info().version},
          {"commit", build_info().commit},
          {"compiler", build_info().compiler},
          {"cases", list}};
}

void print_groups(const Console& console, const std::vector<SelftestCase>& cases) {
  std::vector<TableRow> rows;
  for (const SelftestGroup& group : selftest_groups()) {
    std::ptrdiff_t all = 0, ok = 0;
    for (const SelftestCase& one : cases) {
      if (one.group != group.name) continue;
      ++all;
      ok += one.ok() ? 1 : 0;
    }
    rows.push_back({std::string(group.name), fmt::format("{} of {}", ok, all), std::string(group.answers)});
  }
  console.table({"group", "passed", "compared with"}, rows);
}

int run_selftest(Console& console, bool all, std::stop_token stop) {
  console.phase("self-test");
  const auto cases = selftest(std::move(stop));
  console.end_progress();
  if (!cases) return report_error(console, cases.error());
  const std::ptrdiff_t failed = std::count_if(cases->begin(), cases->end(), [](const auto& one) { return !one.ok(); });
  const Json json = selftest_json(*cases, failed);
  const auto passed = static_cast<std::ptrdiff_t>(cases->size()) - failed;
  const std::filesystem::path file = selftest_file();
  const auto kept = keep_selftest(file, {.utc = {},
                                         .passed = static_cast<int>(passed),
                                         .failed = static_cast<int>(failed),
                                         .cases_sha256 = sha256_of(json["cases"].dump()),
                                         .program_version = {},
                                         .git_commit = {},
                                         .compiler = {},
                                         .host = {}});
  if (!kept) console.note("later sessions cannot state this result: " + kept.error().message);
  if (console.json()) {
    console.object(json);
    return failed == 0 ? 0 : a_case_failed;
  }
  print_groups(console, *cases);
  std::vector<TableRow> rows;
  for (const SelftestCase& one : *cases) {
    if (all || !one.ok())
      rows.push_back({std::string(one.group), one.name, number(one.value), number(one.expected), number(one.tolerance),
                      one.ok() ? "ok" : "FAILED"});
  }
  if (!rows.empty()) console.table({"group", "case", "value", "expected", "tolerance", ""}, rows);
  console.text(fmt::format("verified on this machine: {} of {}", passed, cases->size()));
  return failed == 0 ? 0 : a_case_failed;
}

}  // namespace

void add_selftest_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "selftest", "compares the numbers of this machine with known answers: closed forms, 50 digits, hard cases");
  auto all = std::make_shared<bool>(false);
  command->add_flag("--all", *all, "lists every case; default: only those that fail");
  finish_command(*command, program,
                 [all, &program](Console& console) { return run_selftest(console, *all, program.stop->token()); });
}

}  // namespace todbench
