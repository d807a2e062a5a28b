// SPDX-License-Identifier: GPL-3.0-or-later
// todbench blind
#include "bench/cli/commands.h"

#include <memory>
#include <string>
#include <vector>

#include "bench/cli/run_display.h"
#include "bench/cli/session_argument.h"
#include "bench/enhance/blind_judgement.h"
#include "bench/enhance/decidable.h"
#include "bench/judgement/verdict.h"
#include "bench/report/number_format.h"
#include "bench/session/provenance.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct BlindArguments {
  std::string session, out;
  std::vector<std::string> packages;
  bool simulated = false, simulated_person = false;
  int per_size = 8;
};

void show(Console& console, const BlindResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t s = 0; s < result.sources.size(); ++s) {
    for (const TodPoint& point : result.records[s].curve.points) {
      std::string ratio;
      if (s > 0) {
        for (const ComparisonPoint& compared : result.ratios[s - 1].points) {
          if (compared.set_delta_t_k == point.set_delta_t_k) ratio = with_interval(compared.ratio, compared.ratio_ci95);
        }
      }
      rows.push_back({result.sources[s], number_text(point.set_delta_t_k),
                      with_interval(identified_threshold(point.fit), point.fit.ci95), ratio});
    }
  }
  console.table({"source", "set dT (K)", "S75 (mrad) [95 %]", "acuity / " + result.sources.front() + " [95 %]"}, rows);
  for (std::size_t s = 0; s < result.sources.size(); ++s) {
    for (const TodPoint& point : result.records[s].curve.points) {
      if (const auto why = why_undecided(result.sources[s], point); !why.empty())
        console.text("not fit for a decision: " + number_text(point.set_delta_t_k) + " K: " + why);
    }
  }
}

/// The answers of a person who sees as the model observer does.
std::vector<BlindAnswer> model_answers(const std::vector<BlindPatch>& patches) {
  std::vector<BlindAnswer> answers;
  for (const BlindPatch& patch : patches) {
    BlindAnswer answer{.source = patch.source, .trial = patch.judged.trial};
    answer.trial.probability_correct.reset();
    answer.trial.frames = 1;
    answer.shown.kelvin = patch.judged.patch_k;
    answers.push_back(std::move(answer));
  }
  return answers;
}

int run_blind(Console& console, const BlindArguments& a, const Program& program) {
  if (!a.simulated_person) {
    return report_error(
        console, {ErrorCode::invalid_input,
                  "people answer in the window, on the page Human observer, question 'Several sources, blind'. On the "
                  "command line, add --simulated-person: the model observer then answers in place of a person"});
  }
  std::vector<EnhancementPackage> packages;
  for (const std::string& file : a.packages) {
    auto package = read_package(file);
    if (!package) return report_error(console, package.error());
    packages.push_back(*std::move(package));
  }
  const auto session = opened(console, a.session, {});
  if (!session) return report_error(console, session.error());
  const auto sources =
      blind_sources(a.session, packages, a.simulated, a.out, listener_of(console), program.stop->token());
  console.end_progress();
  if (!sources) return report_error(console, sources.error());
  const std::uint64_t seed = program.common.seed;
  const auto patches = blind_order(*sources, a.per_size, seed);
  if (!patches) return report_error(console, patches.error());
  std::vector<std::string> names;
  for (const BlindSource& source : *sources) names.push_back(source.name);
  const std::vector<BlindAnswer> answers = model_answers(*patches);
  const auto result = blind_result(names, answers, session->plan);
  if (!result) return report_error(console, result.error());
  PersonFacts person;
  person.code = "model observer";
  person.judged_utc = utc_now();
  if (auto written = write_blind(a.out, *result, answers, person, seed); !written)
    return report_error(console, written.error());
  if (console.json()) {
    console.object(blind_json(*result, person, seed));
  } else {
    show(console, *result);
  }
  return exit_code(*result);
}

}  // namespace

void add_blind_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "blind",
      "judges the recorded frames of a session, their twin and the frames behind enhancement packages in one mixed "
      "order: S75 of each source and ratios of acuity");
  auto a = std::make_shared<BlindArguments>();
  command->add_option("SESSION", a->session, "session folder with recorded frames")->required();
  command->add_option("--packages", a->packages, "files of enhancement packages, each a source");
  command->add_flag("--simulated", a->simulated, "the simulated twin is a source, too");
  command->add_option("--per-size", a->per_size, "pictures of each source for each contrast and size")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--simulated-person", a->simulated_person, "answers as the model observer of the session");
  command->add_option("--out", a->out, "folder of the answers, the result and the sessions of the sources")->required();
  finish_command(*command, program, [a, &program](Console& console) { return run_blind(console, *a, program); });
}

}  // namespace todbench
