// SPDX-License-Identifier: GPL-3.0-or-later
// todbench instrument
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/exit_codes.h"
#include "bench/cli/run_display.h"
#include "bench/devices/stage_check.h"
#include "bench/plan/instrument_description.h"
#include "bench/session/json_output.h"
#include "tod/instruments/instrument_check.h"

namespace todbench {
namespace {

struct InstrumentArguments {
  std::string file, address;
  std::string plan;  ///< its camera observes the stage; empty: no camera
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

Json matrix_json(const cv::Matx22d& m) {
  return {{m(0, 0), m(0, 1)}, {m(1, 0), m(1, 1)}};
}

Json movement_json(const std::optional<StageMovement>& movement) {
  if (!movement) return {};
  return {{"driven_px", movement->driven_px},
          {"seen_per_asked", matrix_json(movement->fit.seen_per_asked)},
          {"standard_error", matrix_json(movement->fit.standard_error)},
          {"cause", movement->cause.empty() ? Json() : Json(movement->cause)}};
}

Json check_json(const InstrumentTable& table, const std::string& address, const InstrumentCheck& check,
                const std::optional<StageMovement>& movement) {
  Json steps = Json::array();
  for (const auto& step : check.steps)
    steps.push_back({{"step", step.name},
                     {"sent", step.sent.empty() ? Json(nullptr) : Json(step.sent)},
                     {"outcome", outcome_word(step.outcome)},
                     {"said", step.said}});
  const ScpiIdentity& who = check.identity;
  const Json identity = {
      {"vendor", who.vendor}, {"model", who.model}, {"serial", who.serial}, {"firmware", who.firmware}};
  return {{"ok", check.passed()}, {"kind", to_string(table.kind)},
          {"address", address},   {"identity", check.reached ? identity : Json(nullptr)},
          {"steps", steps},       {"movement", movement_json(movement)}};
}

std::string step_line(const InstrumentStep& step) {
  const std::string sent = step.sent.empty() ? "" : "  " + step.sent;
  return fmt::format("{:<9}  {:<27}{}\n{:>11}{}", outcome_word(step.outcome), step.name, sent, "", one_line(step.said));
}

InstrumentStep step_of(const StageMovement& movement) {
  const cv::Matx22d& m = movement.fit.seen_per_asked;
  const std::string seen = fmt::format(
      "one pixel along x moves the picture by ({:.3f}, {:.3f}) px, one along y by "
      "({:.3f}, {:.3f}) px",
      m(0, 0), m(1, 0), m(0, 1), m(1, 1));
  if (movement.cause.empty()) return {"movement in the picture", "", StepOutcome::answered, seen};
  return {"movement in the picture", "", StepOutcome::failed, movement.cause + " (" + seen + ")"};
}

/// Measures the movement of this stage with the camera of a plan.
Result<StageMovement> movement_of(Console& console, Program& program, const InstrumentArguments& a,
                                  const InstrumentTable& table) {
  if (table.kind != InstrumentKind::stage)
    return fail(ErrorCode::invalid_input, "--camera needs a stage, but " + a.file + " describes a black body");
  TODBENCH_TRY(const auto read, read_camera_plan(a.plan));
  Plan plan = read.plan();
  if (plan.target.kind != TargetKind::scpi)
    return fail(ErrorCode::invalid_input, "--camera needs a plan with [target] kind = \"scpi\"");
  plan.target.stage = a.address;
  plan.target.stage_table = a.file;
  TODBENCH_TRY(const auto loaded, LoadedPlan::load(plan));
  return check_stage_movement(
      loaded, [&](std::string_view sentence) { console.phase(std::string(sentence)); }, program.stop->token());
}

int check_one(Console& console, Program& program, const InstrumentArguments& a) {
  const auto table = load_instrument(a.file);
  if (!table) return report_error(console, table.error());
  auto check = check_instrument(*table, a.address, a.set ? InstrumentCommands::in_place : InstrumentCommands::none, {},
                                program.stop->token());
  if (!check) return report_error(console, check.error());
  std::optional<StageMovement> movement;
  if (!a.plan.empty() && check->reached) {
    const auto moved = movement_of(console, program, a, *table);
    if (!moved) return report_error(console, moved.error());
    movement = *moved;
    check->steps.push_back(step_of(*moved));
  }
  if (console.json()) {
    console.object(check_json(*table, a.address, *check, movement));
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
  auto* instrument =
      app.add_subcommand("instrument", "tests black bodies and stages that a file of commands describes");
  instrument->require_subcommand(1);
  auto* check = instrument->add_subcommand(
      "check", "sends the commands of the file to an instrument step by step and reports which ones fail");
  auto a = std::make_shared<InstrumentArguments>();
  check->add_option("FILE", a->file, "commands of the instrument: name or file")->required();
  check
      ->add_option("ADDRESS", a->address,
                   "address of the instrument: HOST:PORT, serial:/dev/NAME or vxi11:HOST[:PORT][/DEVICE]")
      ->required();
  check->add_option("--camera", a->plan,
                    "plan whose camera observes the stage; moves each axis once and tests sign, axis and scale in the "
                    "pictures");
  check->add_flag("--set", a->set, "also tests the set commands, each with the present value of the instrument");
  finish_command(*check, program, [a, &program](Console& console) { return check_one(console, program, *a); });
}

}  // namespace todbench
