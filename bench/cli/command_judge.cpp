// SPDX-License-Identifier: GPL-3.0-or-later
// todbench judge
#include "bench/cli/commands.h"

#include <memory>
#include <string>
#include <utility>

#include "bench/cli/judge_bars.h"
#include "bench/cli/run_display.h"
#include "bench/cli/run_results.h"
#include "bench/cli/session_argument.h"
#include "bench/enhance/judge_again.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {
namespace {

struct JudgeArguments {
  std::string session, out, package, display;
  JudgeRequest request{};
  Opening opening{};
  bool overwrite = false, run_modules = false;
  BarsArguments bars{};
};

int run_judge(Console& console, JudgeArguments a, const Program& program) {
  if (a.bars.questions || !a.bars.answers.empty()) {
    a.bars.session = a.session, a.bars.out = a.out, a.bars.opening = a.opening;
    a.bars.request.seed = program.common.seed;
    return run_judge_bars(console, a.bars);
  }
  if (a.out.empty())
    return report_error(console, {ErrorCode::invalid_input, "--out is missing: the folder of the new session"});
  if (!a.package.empty()) {
    auto package = read_package(a.package);
    if (!package) return report_error(console, package.error());
    a.request.package = *std::move(package);
  }
  if (!a.display.empty()) {
    const auto plan = load_plan(a.display);
    if (!plan) return report_error(console, with_context("--display", plan.error()));
    if (!has_display(*plan))
      return report_error(console,
                          {ErrorCode::invalid_input, "--display: the plan " + a.display + " has no section [display]"});
    a.request.display = plan->display;
  }
  const ExperimentOptions options{.folder = a.out,
                                  .existing = a.overwrite ? ExistingFolder::overwrite : ExistingFolder::refuse};
  const auto outcome = judge_again(a.session, a.request, options, listener_of(console), program.stop->token(),
                                   a.opening, a.run_modules ? RunModules::yes : RunModules::no);
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  return show_run(console, *outcome);
}

}  // namespace

void add_judge_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "judge",
      "judges the recorded frames of a session again, by another observer or through an enhancement package, into a "
      "new session");
  auto a = std::make_shared<JudgeArguments>();
  command->add_option("SESSION", a->session, "session folder with recorded frames")->required();
  command->add_option("--observer", a->request.observer, "observer: name or file; default: that of the session");
  command->add_option("--package", a->package, "file of an enhancement package behind the camera and its twin");
  command->add_option("--display", a->display,
                      "plan, name or file, whose section [display] an observer with an eye uses; default: that of the "
                      "session");
  command->add_option("--out", a->out, "folder of the new session, or of the pictures of --bars");
  command->add_flag("--force", a->overwrite, "overwrites the session in an existing folder");
  command->add_flag("--run-modules", a->run_modules, "starts the programs that the session names in [[module]]");
  add_accept_changed(*command, a->opening.accept_changed);
  add_bars_options(*command, a->bars);
  finish_command(*command, program, [a, &program](Console& console) { return run_judge(console, *a, program); });
}

}  // namespace todbench
