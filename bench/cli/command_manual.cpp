// SPDX-License-Identifier: GPL-3.0-or-later
// todbench manual, todbench complete WORDS...: for packages and the shell; help does not list them.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/devices/devices.h"
#include "bench/session/build_info.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

struct ManualArguments {
  std::string folder, date;
};

int run_manual(Console& console, const CLI::App& app, const ManualArguments& arguments) {
  const std::string version = app.get_name() + " " + std::string(build_info().version);
  for (const ManualPage& page : manual_pages(app, version, arguments.date)) {
    const auto file = std::filesystem::path(arguments.folder) / (page.name + ".1");
    if (const auto written = write_file_atomically(file, roff(page)); !written)
      return report_error(console, written.error());
  }
  return 0;
}

std::vector<std::string> cameras_now() {
  std::vector<std::string> ids;
  for (const auto& camera : camera_registry().list().cameras) ids.push_back(camera.id);
  return ids;
}

CLI::Validator is_date() {
  return {[](const std::string& text) {
            const bool fits = text.size() == 10 && text.find_first_not_of("0123456789-") == std::string::npos;
            return fits ? std::string() : "expected a date, YYYY-MM-DD";
          },
          ""};
}

}  // namespace

void print_completions(const CLI::App& app, const std::vector<std::string>& words) {
  const Completion offered = completion(app, words, cameras_now);
  const Console console({});
  for (const std::string& word : offered.words) console.text(word);
  // No word of the program starts with a colon.
  if (offered.files) console.text(":files");
}

void add_manual_command(CLI::App& app, Program& program) {
  auto* manual = app.add_subcommand("manual", "writes the manual pages for man(1)");
  auto a = std::make_shared<ManualArguments>();
  manual->add_option("--out", a->folder, "existing folder for the pages")->required();
  manual->add_option("--date", a->date, "date of the release, YYYY-MM-DD")->required()->check(is_date());
  manual->group("");
  manual->callback([a, &app, &program] {
    program.chosen = [a, &app] {
      Console console({});
      return run_manual(console, app, *a);
    };
  });
}

}  // namespace todbench
