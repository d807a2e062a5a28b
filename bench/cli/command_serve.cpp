// SPDX-License-Identifier: GPL-3.0-or-later
// todbench serve
#include <memory>

#include "bench/cli/commands.h"
#include "bench/devices/devices.h"
#include "bench/run_control/control_server.h"

namespace todbench {
namespace {

struct RunServiceArguments {
  std::string address = "127.0.0.1:8765";
  std::string token_file, sessions = ".";
  bool modules = false;
};

int run_serve(Console& console, const RunServiceArguments& arguments, StopSignals& stop) {
  const auto address = serve_address(arguments.address, Reach::network);
  if (!address) return report_error(console, with_context("--address", address.error()));
  ControlServerOptions options{.address = *address,
                               .sessions = arguments.sessions,
                               .programs = arguments.modules ? PlanPrograms::modules : PlanPrograms::none,
                               .list_cameras = [] { return camera_registry().list(); }};
  if (!arguments.token_file.empty()) {
    const auto token = kept_token(arguments.token_file);
    if (!token) return report_error(console, with_context("--token-file", token.error()));
    options.token = *token;
  }
  stop.observe();
  const auto server = ControlServer::start(options);
  if (!server) return report_error(console, with_context("--address", server.error()));
  if (!serve_address(arguments.address, Reach::this_computer)) {
    console.warning("other computers can reach " + arguments.address +
                    ", and the token travels unencrypted: use a trusted network or a tunnel");
  }
  const std::string page = (*server)->url() + "#token=" + (*server)->token();
  if (console.json()) {
    console.object({{"url", (*server)->url()}, {"token", (*server)->token()}, {"page", page}});
  } else {
    console.text("page: " + page);
    console.text("interface: " + (*server)->url() + "api/v1/openapi.json");
    console.text("token: " + (*server)->token());
    console.text("running until Ctrl-C");
  }
  if (auto written = finish_output(); !written) return report_error(console, written.error());
  stop.wait();
  return 130;
}

}  // namespace

void add_serve_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "serve", "starts and shows runs for other programs and browsers: HTTP and JSON with a token, until Ctrl-C");
  auto a = std::make_shared<RunServiceArguments>();
  command->add_option("--address", a->address, "HOST:PORT to listen on; port 0: any free one")->capture_default_str();
  command->add_option("--token-file", a->token_file,
                      "reads the token from this file and creates the file if it is absent; default: a new token");
  command->add_option("--sessions", a->sessions, "folder in which the session folders are created")
      ->capture_default_str();
  command->add_flag("--allow-modules", a->modules,
                    "also runs plans that start programs: [[module]], or a target of kind display");
  finish_command(*command, program, [a, &program](Console& console) { return run_serve(console, *a, *program.stop); });
}

}  // namespace todbench
