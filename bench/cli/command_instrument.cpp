// todbench instrument
#include <fmt/format.h>

#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/exit_codes.h"
#include "bench/plan/instrument_description.h"
#include "bench/session/json_output.h"
#include "tod/instruments/instrument_check.h"

namespace todbench {
namespace {

struct InstrumentArguments {
  std::string file, address;
  bool set = false;
};

std::string_view outcome_word(StepOutcome outcome) {
  switch (outcome) {
    case StepOutcome::answered:
      return "ok";
    case StepOutcome::failed:
      return "failed";
    case StepOutcome::not_tried:
      return "not tried";
  }
  return "";
}

Json check_json(const InstrumentTable& table, const std::string& address, const InstrumentCheck& check) {
  Json steps = Json::array();
  for (const auto& step : check.steps)
    steps.push_back({{"step", step.name},
                     {"sent", step.sent.empty() ? Json(nullptr) : Json(step.sent)},
                     {"outcome", outcome_word(step.outcome)},
                     {"said", step.said}});
  const ScpiIdentity& who = check.identity;
  const Json identity = {
      {"vendor", who.vendor}, {"model", who.model}, {"serial", who.serial}, {"firmware", who.firmware}};
  return {{"ok", check.passed()},
          {"kind", to_string(table.kind)},
          {"address", address},
          {"identity", check.reached ? identity : Json(nullptr)},
          {"steps", steps}};
}

std::string step_line(const InstrumentStep& step) {
  const std::string sent = step.sent.empty() ? "" : "  " + step.sent;
  return fmt::format("{:<9}  {:<27}{}\n{:>11}{}", outcome_word(step.outcome), step.name, sent, "", one_line(step.said));
}

int check_one(Console& console, Program& program, const InstrumentArguments& a) {
  const auto table = load_instrument(a.file);
  if (!table) return report_error(console, table.error());
  const auto check = check_instrument(
      *table, a.address, a.set ? InstrumentCommands::in_place : InstrumentCommands::none, {}, program.stop->token());
  if (!check) return report_error(console, check.error());
  if (console.json()) {
    console.object(check_json(*table, a.address, *check));
  } else {
    for (const auto& step : check->steps) console.text(step_line(step));
  }
  if (check->passed()) return 0;
  if (!check->reached) return report_error(console, {ErrorCode::not_found, check->steps.front().said});
  std::size_t failed = 0;
  for (const auto& step : check->steps) failed += step.outcome == StepOutcome::failed ? 1 : 0;
  return report_error(console, {ErrorCode::disconnected,
                                fmt::format("{}: {} of {} steps failed", a.address, failed, check->steps.size())});
}

}  // namespace

void add_instrument_command(CLI::App& app, Program& program) {
  auto* instrument = app.add_subcommand("instrument", "black bodies and stages by the words of a file");
  instrument->require_subcommand(1);
  auto* check =
      instrument->add_subcommand("check", "talks to an instrument step by step and says what does not answer");
  auto a = std::make_shared<InstrumentArguments>();
  check->add_option("FILE", a->file, "words of the instrument: name or file")->required();
  check->add_option("ADDRESS", a->address, "HOST:PORT, serial:/dev/NAME or vxi11:HOST[:PORT][/DEVICE]")->required();
  check->add_flag("--set", a->set, "tries the commands too, each with the value that the instrument has");
  finish_command(*check, program, [a, &program](Console& console) { return check_one(console, program, *a); });
}

}  // namespace todbench
