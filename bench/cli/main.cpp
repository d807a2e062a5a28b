// todbench: the command line.
#include <cstdio>
#include <exception>

#include "bench/cli/commands.h"
#include "bench/session/build_info.h"
#include "bench/session/text.h"
#include "bench/session/verdict.h"

namespace todbench {

void finish_command(CLI::App& command, Program& program, std::function<int(Console&)> action) {
  command.add_flag("--json", program.common.console.json, "one JSON object on standard output, nothing else there");
  command.add_flag("--quiet,-q", program.common.console.quiet, "no progress and no notes on standard error");
  command.add_option("--seed", program.common.seed, "fixes all randomness")
      ->capture_default_str()
      ->each([&program](const std::string&) { program.common.seed_given = true; });
  command.callback([&program, action = std::move(action)] {
    program.chosen = [&program, action] {
      Console console(program.common.console);
      return action(console);
    };
  });
}

int report_error(Console& console, const Error& error) {
  console.error(error.message);
  return exit_code(error.code);
}

namespace {

int run(int argc, char** argv) {
  StopSignals stop;
  Program program;
  program.stop = &stop;
  CLI::App app("Measures the TOD of thermal cameras with a model observer, and of their simulated twins.", "todbench");
  app.require_subcommand(1);
  const BuildInfo info = build_info();
  app.set_version_flag("--version", "todbench " + std::string(info.version) + " (" + std::string(info.commit) + ")");
  add_demo_command(app, program);
  add_devices_command(app, program);
  add_emulate_command(app, program);
  add_measure_command(app, program);
  add_simulate_command(app, program);
  add_compare_command(app, program);
  add_report_command(app, program);
  add_fit_command(app, program);
  add_render_command(app, program);
  add_mtf_command(app, program);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "todbench: %s (todbench --help lists what can be asked)\n", one_line(error.what()).c_str());
    return exit_code(ErrorCode::invalid_input);
  }
  return program.chosen();
}

}  // namespace
}  // namespace todbench

int main(int argc, char** argv) {
  // Nothing of the project throws across its interfaces; what third-party code throws is a defect, not a crash.
  try {
    return todbench::run(argc, argv);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "todbench: internal error: %s\n", exception.what());
    return 7;
  }
}
