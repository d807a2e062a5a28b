// SPDX-License-Identifier: GPL-3.0-or-later
// todbench reference-set
#include <filesystem>
#include <memory>
#include <system_error>

#include "bench/cli/commands.h"
#include "bench/judgement/verdict.h"
#include "bench/reference_set/reference_files.h"
#include "bench/reference_set/reference_score.h"
#include "bench/reference_set/reference_set.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct ReferenceSetArguments {
  std::string out, check, against;
};

int run_write(Console& console, const ReferenceSetArguments& a, const Program& program) {
  const std::filesystem::path folder = a.out;
  std::error_code problem;
  if (std::filesystem::exists(folder, problem) &&
      (!std::filesystem::is_directory(folder, problem) || !std::filesystem::is_empty(folder, problem))) {
    return report_error(console, {ErrorCode::invalid_input, folder.string() + ": expected a new or an empty folder"});
  }
  if (auto made = make_folder(folder); !made) return report_error(console, made.error());
  ReferenceSetOptions options;
  options.seed = program.common.seed;
  options.on_progress = [&console](std::size_t done, std::size_t planned) { console.progress(done, planned); };
  console.phase("writing the reference set");
  const auto written = write_reference_set(folder, options, program.stop->token());
  console.end_progress();
  if (!written) return report_error(console, written.error());
  const auto truths = read_truths(folder);
  if (!truths) return report_error(console, truths.error());
  if (console.json()) {
    Json cases = Json::array();
    for (const ReferenceTruth& truth : *truths) {
      cases.push_back({{"case", truth.name},
                       {"s75_mrad", json_number(truth.s75_mrad)},
                       {"s75_standard_error_mrad", json_number(truth.standard_error_mrad)}});
    }
    console.object({{"reference_set", folder.string()},
                    {"schema", reference_set_name},
                    {"seed", options.seed},
                    {"cases", std::move(cases)}});
    return 0;
  }
  std::vector<TableRow> rows;
  for (const ReferenceTruth& truth : *truths)
    rows.push_back({truth.name, fixed(truth.s75_mrad, 4), fixed(truth.standard_error_mrad, 4)});
  console.table({"case", "S75 [mrad]", "standard error [mrad]"}, rows);
  console.text(folder.string());
  return 0;
}

Json score_json(const ReferenceScore& found) {
  Json cases = Json::array();
  for (const CaseScore& one : found.cases) {
    cases.push_back({{"case", one.truth.name},
                     {"truth_mrad", json_number(one.truth.s75_mrad)},
                     {"truth_standard_error_mrad", json_number(one.truth.standard_error_mrad)},
                     {"s75_mrad", json_number(one.result.s75_mrad)},
                     {"deviation_percent", json_number(one.deviation_percent)},
                     {"within", one.within},
                     {"interval_holds", one.interval_holds ? Json(*one.interval_holds) : Json(nullptr)}});
  }
  return {{"schema", reference_set_name},
          {"cases", std::move(cases)},
          {"tolerance_percent", json_number(reference_tolerance_percent)},
          {"mean_deviation_percent", json_number(found.mean_deviation_percent)},
          {"rms_deviation_percent", json_number(found.rms_deviation_percent)},
          {"verdict", found.passed ? "pass" : "fail"}};
}

void print_score(const Console& console, const ReferenceScore& found) {
  std::vector<TableRow> rows;
  for (const CaseScore& one : found.cases) {
    rows.push_back({one.truth.name, fixed(one.truth.s75_mrad, 4), fixed(one.result.s75_mrad, 4),
                    fixed(one.deviation_percent, 2), one.within ? "yes" : "no",
                    one.interval_holds ? (*one.interval_holds ? "yes" : "no") : "–"});
  }
  console.table({"case", "S75 [mrad]", "result [mrad]", "deviation [%]", "within tolerance", "interval contains truth"},
                rows);
  console.text("mean deviation " + fixed(found.mean_deviation_percent, 2) + " %, root mean square " +
               fixed(found.rms_deviation_percent, 2) + " %; tolerance " + number_text(reference_tolerance_percent) +
               " %: " + (found.passed ? "pass" : "fail"));
}

int run_check(Console& console, const ReferenceSetArguments& a, const Program& program) {
  const auto text = read_text_file(a.check);
  if (!text) return report_error(console, text.error());
  console.phase("computing the thresholds of the reference set");
  const auto truths =
      a.against.empty() ? reference_truths(reference_cases(), program.stop->token()) : read_truths(a.against);
  console.end_progress();
  if (!truths) return report_error(console, truths.error());
  const auto results = parse_reference_result(*text, a.check, *truths);
  if (!results) return report_error(console, results.error());
  const ReferenceScore found = score(*truths, *results);
  if (console.json()) {
    console.object(score_json(found));
  } else {
    print_score(console, found);
  }
  return found.passed ? 0 : 1;
}

}  // namespace

void add_reference_set_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "reference-set", "writes frames of simulated cameras with known thresholds, or scores a result against them");
  auto a = std::make_shared<ReferenceSetArguments>();
  auto* out = command->add_option("--out", a->out, "new or empty folder for the reference set");
  auto* check = command->add_option("--check", a->check, "result to score: a CSV file with the columns case,s75_mrad")
                    ->excludes(out);
  command
      ->add_option("--against", a->against,
                   "folder of a reference set with the true thresholds; default: they are computed again")
      ->needs(check);
  finish_command(*command, program, [a, &program](Console& console) {
    if (!a->check.empty()) return run_check(console, *a, program);
    if (!a->out.empty()) return run_write(console, *a, program);
    return report_error(console, {ErrorCode::invalid_input, "reference-set: expected --out DIR or --check RESULT.csv"});
  });
}

}  // namespace todbench
