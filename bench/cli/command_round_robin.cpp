// SPDX-License-Identifier: GPL-3.0-or-later
// todbench round-robin prepare, judge, evaluate
#include <filesystem>
#include <memory>
#include <random>
#include <system_error>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/history/history_session.h"
#include "bench/report/html.h"
#include "bench/round_robin/blind_items.h"
#include "bench/round_robin/round_robin_output.h"
#include "bench/round_robin/sealed_truth.h"
#include "bench/round_robin/submitted_results.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct EvaluateArguments {
  std::vector<std::string> sources;
  std::string sealed, out;
};

/// Results of a CSV file, or of all sessions at or below a folder.
Result<std::vector<SubmittedResult>> results_of(const std::filesystem::path& source) {
  std::error_code problem;
  if (!std::filesystem::is_directory(source, problem)) {
    TODBENCH_TRY(const std::string text, read_text_file(source));
    return parse_submitted_results(text, source.string());
  }
  TODBENCH_TRY(const auto folders, session_folders_below(source));
  if (folders.empty()) return fail(ErrorCode::invalid_input, source.string() + ": contains no session");
  std::vector<SubmittedResult> out;
  for (const auto& folder : folders) {
    TODBENCH_TRY(auto more, session_results(folder));
    out.insert(out.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  }
  return out;
}

/// Comparison with the checks against the sealed values, if any.
struct Evaluation {
  RoundRobin found;
  std::vector<TruthCheck> truths;
};

Result<Evaluation> evaluation_of(const EvaluateArguments& a, std::uint64_t seed) {
  std::vector<SubmittedResult> results;
  for (const std::string& source : a.sources) {
    TODBENCH_TRY(auto more, results_of(source));
    results.insert(results.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  }
  TODBENCH_TRY(auto items, compared_items(results));
  TODBENCH_TRY(auto found, evaluated(std::move(items), seed));
  Evaluation out{std::move(found), {}};
  if (a.sealed.empty()) return out;
  TODBENCH_TRY(const auto sealed, read_sealed(a.sealed));
  TODBENCH_TRY(out.truths, checked_against(out.found, sealed));
  return out;
}

Result<void> write_evaluation(const std::filesystem::path& folder, const Evaluation& evaluation) {
  TODBENCH_TRY_VOID(make_folder(folder));
  const std::pair<const char*, std::string> files[]{
      {"round-robin.html", render_html(round_robin_page(evaluation.found, evaluation.truths))},
      {"round-robin.json", to_page(round_robin_json(evaluation.found, evaluation.truths))},
      {"degrees.csv", round_robin_csv(evaluation.found)}};
  for (const auto& [name, content] : files) {
    TODBENCH_TRY_VOID(write_file_atomically(folder / name, content));
  }
  return {};
}

void print_evaluation(Console& console, const Evaluation& evaluation) {
  std::vector<TableRow> references, degrees;
  for (std::size_t j = 0; j < evaluation.found.items.size(); ++j) {
    const ItemComparison& item = evaluation.found.items[j];
    references.push_back({item.item.item, item.item.quantity, std::string(to_string(item.reference.method)),
                          fixed(item.reference.value.value, 4), fixed(item.reference.expanded_u, 4),
                          fixed(item.all.p, 3), fixed(item.all.birge_ratio, 2),
                          evaluation.truths.empty() ? "–" : fixed(evaluation.truths[j].truth.value, 4)});
    for (const DegreeOfEquivalence& degree : item.degrees)
      degrees.push_back({item.item.item, item.item.quantity, degree.result.laboratory, fixed(degree.difference, 4),
                         fixed(degree.expanded_u, 4), fixed(degree.e_n, 2), degree.outlying ? "outlying" : ""});
  }
  console.table({"item", "quantity", "reference value", "value", "U", "p of chi2", "Birge ratio", "sealed"},
                references);
  console.text("");
  console.table({"item", "quantity", "laboratory", "difference", "U, k = 2", "E_n", ""}, degrees);
  for (const OutlyingResult& one : evaluation.found.outlying)
    console.text("outlying: " + one.laboratory + (one.item.empty() ? ", over all its items" : ", item " + one.item) +
                 ", zeta " + fixed(one.zeta, 2) + ", p " + fixed(one.p, 4));
  console.text("verdict: " + std::string(verdict_word(evaluation.found)));
}

int run_evaluate(Console& console, const EvaluateArguments& a, const Program& program) {
  const auto evaluation = evaluation_of(a, program.common.seed);
  if (!evaluation) return report_error(console, evaluation.error());
  if (!a.out.empty()) {
    if (auto written = write_evaluation(a.out, *evaluation); !written) return report_error(console, written.error());
  }
  if (console.json())
    console.object(round_robin_json(evaluation->found, evaluation->truths));
  else
    print_evaluation(console, *evaluation);
  if (!evaluation->found.outlying.empty()) return 1;
  return evaluation->found.consistent() ? 0 : 3;
}

void add_evaluate(CLI::App& group, Program& program) {
  auto* command = group.add_subcommand(
      "evaluate", "reference values, degrees of equivalence, E_n and outlying laboratories from collected results");
  auto a = std::make_shared<EvaluateArguments>();
  command
      ->add_option(
          "RESULTS", a->sources,
          "CSV files with the columns laboratory, item, quantity, value and u (or expanded_u and k, or ci95_low "
          "and ci95_high); or session folders")
      ->required();
  command->add_option("--sealed", a->sealed, "sealed file of the coordinator with the true values");
  command->add_option("--out", a->out, "folder for the page, the numbers and the table");
  finish_command(*command, program, [a, &program](Console& console) { return run_evaluate(console, *a, program); });
}

struct PrepareArguments {
  std::string out;
  BlindOptions options;
};

/// A seed that nobody can guess. It is written into the sealed file.
std::uint64_t secret_seed() {
  std::random_device system;
  return (static_cast<std::uint64_t>(system()) << 32 | system()) >> 11;  // 53 bits, exact in every reader of JSON
}

int run_prepare(Console& console, PrepareArguments a, const Program& program) {
  const std::filesystem::path folder = a.out;
  std::error_code problem;
  if (std::filesystem::exists(folder, problem) &&
      (!std::filesystem::is_directory(folder, problem) || !std::filesystem::is_empty(folder, problem)))
    return report_error(console, {ErrorCode::invalid_input, folder.string() + ": expected a new or an empty folder"});
  a.options.seed = program.common.seed_given ? program.common.seed : secret_seed();
  if (program.common.seed_given)
    console.note("a laboratory that knows or guesses --seed knows the true values; without it the seed is secret");
  a.options.on_progress = [&console](std::size_t done, std::size_t planned) { console.progress(done, planned); };
  console.phase("writing blind recordings");
  const auto written = write_blind_comparison(folder, a.options, program.stop->token());
  console.end_progress();
  if (!written) return report_error(console, written.error());
  const std::string sealed = (folder / "sealed.json").string();
  if (console.json()) {
    console.object({{"folder", folder.string()},
                    {"sealed", sealed},
                    {"sealed_sha256", written->sealed_sha256},
                    {"laboratories", a.options.laboratories},
                    {"items", a.options.items},
                    {"frames_per_item", a.options.frames}});
    return 0;
  }
  console.text("recordings: " + (folder / "laboratory-1").string() + " to laboratory-" +
               std::to_string(a.options.laboratories));
  console.text("sealed: " + sealed + ", SHA-256 " + written->sealed_sha256 + "; keep it apart from the recordings");
  return 0;
}

struct JudgeItemsArguments {
  std::string folder, laboratory, observer{reference_observer}, out;
};

int run_judge_items(Console& console, const JudgeItemsArguments& a, const Program& program) {
  if (a.laboratory.empty() || a.laboratory.size() > 100)
    return report_error(console, {ErrorCode::invalid_input, "--laboratory: expected a name of at most 100 bytes"});
  console.phase("judging the recordings");
  const auto results = judged_items(a.folder, a.laboratory, a.observer, program.common.seed, program.stop->token());
  console.end_progress();
  if (!results) return report_error(console, results.error());
  if (auto written = write_file_atomically(a.out, submitted_csv(*results)); !written)
    return report_error(console, written.error());
  Json items = Json::array();
  std::vector<TableRow> rows;
  for (const SubmittedResult& r : *results) {
    items.push_back(
        {{"item", r.item}, {"quantity", r.quantity}, {"value", json_number(r.value)}, {"u", json_number(r.u)}});
    rows.push_back({r.item, r.quantity, fixed(r.value, 4), fixed(r.u, 4)});
  }
  if (console.json()) {
    console.object({{"results", a.out}, {"laboratory", a.laboratory}, {"observer", a.observer}, {"items", items}});
  } else {
    console.table({"item", "quantity", "value", "u"}, rows);
    console.text("results: " + a.out);
  }
  return 0;
}

void add_prepare(CLI::App& group, Program& program) {
  auto* command = group.add_subcommand(
      "prepare", "writes blind recordings of simulated cameras with a protocol for each laboratory, and a sealed file");
  auto a = std::make_shared<PrepareArguments>();
  command->add_option("--out", a->out, "new or empty folder")->required();
  command->add_option("--laboratories", a->options.laboratories, "number of laboratories")
      ->check(whole_number(2, 100))
      ->capture_default_str();
  command->add_option("--items", a->options.items, "number of cameras")
      ->check(whole_number(1, 100))
      ->capture_default_str();
  command->add_option("--frames", a->options.frames, "frames of each item for each laboratory")
      ->check(whole_number(8, 1000))
      ->capture_default_str();
  finish_command(*command, program, [a, &program](Console& console) { return run_prepare(console, *a, program); });
}

void add_judge_items(CLI::App& group, Program& program) {
  auto* command =
      group.add_subcommand("judge", "judges the blind recordings of a laboratory by an observer, as a file of results");
  auto a = std::make_shared<JudgeItemsArguments>();
  command->add_option("FOLDER", a->folder, "folder of the laboratory from round-robin prepare")->required();
  command->add_option("--laboratory", a->laboratory, "name of the laboratory in the results")->required();
  command->add_option("--observer", a->observer, "observer: name or file")->capture_default_str();
  command->add_option("--out", a->out, "CSV file of the results")->required();
  finish_command(*command, program, [a, &program](Console& console) { return run_judge_items(console, *a, program); });
}

}  // namespace

void add_round_robin_command(CLI::App& app, Program& program) {
  auto* group = app.add_subcommand("round-robin",
                                   "interlaboratory comparison: blind recordings, collection of results, reference "
                                   "values and degrees of equivalence");
  group->require_subcommand(1);
  add_prepare(*group, program);
  add_judge_items(*group, program);
  add_evaluate(*group, program);
}

}  // namespace todbench
