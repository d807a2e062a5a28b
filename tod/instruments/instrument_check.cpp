// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/instrument_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/instruments/instrument_device.h"

namespace todbench {
namespace {

std::string joined(const std::vector<std::string>& texts, std::string_view between) {
  return fmt::format("{}", fmt::join(texts, between));
}

/// Records the steps. A stop request ends them.
class Talk {
 public:
  explicit Talk(const std::stop_token& stop) : stop_(stop) {}

  /// `ask` returns the understood answer.
  void step(InstrumentDevice& device, std::string name, std::string sent,
            const std::function<Result<std::string>()>& ask) {
    InstrumentStep made{std::move(name), std::move(sent), StepOutcome::not_tried, ""};
    if (made.sent.empty()) made.said = "not in the instrument table";
    if (made.sent.empty() || interrupted()) {
      steps.push_back(std::move(made));
      return;
    }
    Result<std::string> understood = fail(ErrorCode::internal, "");
    if (auto there = device.ensure_connected(stop_); there)
      understood = ask();
    else
      understood = tl::unexpected(there.error());
    made.outcome = understood ? StepOutcome::answered : StepOutcome::failed;
    made.said = understood ? *understood : understood.error().message;
    steps.push_back(std::move(made));
  }
  [[nodiscard]] bool interrupted() const { return stop_.stop_requested(); }

  std::vector<InstrumentStep> steps;

 private:
  const std::stop_token& stop_;
};

Result<std::string> kelvin_text(const Result<double>& value) {
  if (!value) return tl::unexpected(value.error());
  return fmt::format("{:.4f} K", *value);
}

void settled_step(Talk& talk, InstrumentDevice& device, const std::stop_token& stop) {
  talk.step(device, "settled", device.table().settled.query, [&]() -> Result<std::string> {
    const auto settled = device.is_settled(stop);
    if (!settled) return tl::unexpected(settled.error());
    return std::string(*settled ? "settled" : "settling");
  });
}

void talk_to_black_body(Talk& talk, BlackBodyDevice& device, InstrumentCommands commands, const std::stop_token& stop) {
  const BlackBodyWords& words = device.table().black_body;
  const auto sent = [](const NumberQuestion& question) { return joined(question.queries, "; "); };
  talk.step(device, "limits", sent(words.limits), [&]() -> Result<std::string> {
    TODBENCH_TRY(const auto ends, device.limits(stop));
    if (!(ends[0] < ends[1])) return fail(ErrorCode::disconnected, "the lower limit is not below the upper limit");
    return fmt::format("{:.3f} to {:.3f} K", ends[0], ends[1]);
  });
  std::optional<double> there_k;
  talk.step(device, "set-point", sent(words.set_point), [&]() -> Result<std::string> {
    const auto value = device.set_point(stop);
    if (value) there_k = *value;
    return kelvin_text(value);
  });
  talk.step(device, "measured difference", sent(words.measured), [&]() -> Result<std::string> {
    const auto value = device.measured(stop);
    if (value && !words.set_point.asks()) there_k = *value;
    return kelvin_text(value);
  });
  talk.step(device, "plate temperature", sent(words.plate),
            [&] { return kelvin_text(device.temperature(words.plate, stop)); });
  talk.step(device, "radiator temperature", sent(words.radiator),
            [&] { return kelvin_text(device.temperature(words.radiator, stop)); });
  settled_step(talk, device, stop);
  if (commands == InstrumentCommands::none || !there_k) return;
  talk.step(device, "difference command", device.set_command(*there_k), [&]() -> Result<std::string> {
    TODBENCH_TRY_VOID(device.send(device.set_command(*there_k), stop));
    return std::string("accepted");
  });
}

/// A command with the present value.
void command_step(Talk& talk, StageDevice& device, const std::string& name, const std::vector<std::string>& texts,
                  const std::stop_token& stop) {
  talk.step(device, name, joined(texts, "; "), [&]() -> Result<std::string> {
    for (const auto& text : texts) {
      TODBENCH_TRY_VOID(device.send(text, stop));
    }
    return std::string("accepted");
  });
}

void talk_to_stage(Talk& talk, StageDevice& device, InstrumentCommands commands, const std::stop_token& stop) {
  const StageWords& words = device.table().stage;
  std::optional<std::string> plate;
  std::optional<Mounting> mounting;
  std::optional<cv::Point2d> place;
  talk.step(device, "plates", words.catalogue, [&]() -> Result<std::string> {
    TODBENCH_TRY(const auto names, device.plate_names(stop));
    return joined(names, ", ");
  });
  for (const auto& [name, query] :
       {std::pair("requested plate", &words.plate.set_point), std::pair("actual plate", &words.plate.measured)}) {
    talk.step(device, name, *query, [&, text = *query]() -> Result<std::string> {
      auto found = device.plate(text, stop);
      if (found) plate = *found;
      return found;
    });
  }
  for (const auto& [name, query] : {std::pair("requested mounting", &words.mounting.set_point),
                                    std::pair("actual mounting", &words.mounting.measured)}) {
    talk.step(device, name, *query, [&, text = *query]() -> Result<std::string> {
      TODBENCH_TRY(const auto found, device.mounting(text, stop));
      mounting = found;
      return std::string(to_string(found));
    });
  }
  if (words.position) {
    const auto sent = [](const NumberQuestion& question) { return joined(question.queries, "; "); };
    talk.step(device, "travel", sent(words.position->limits), [&]() -> Result<std::string> {
      TODBENCH_TRY(const auto ends, device.travel(stop));
      return fmt::format("{:.3f} to {:.3f} mm, {:.3f} to {:.3f} mm", ends[0], ends[1], ends[2], ends[3]);
    });
    for (const auto& [name, question] : {std::pair("requested position", &words.position->set_point),
                                         std::pair("measured position", &words.position->measured)}) {
      talk.step(device, name, sent(*question), [&, asked = *question]() -> Result<std::string> {
        TODBENCH_TRY(const auto found, device.position(asked, stop));
        place = found;
        return fmt::format("{:.3f}, {:.3f} mm", found.x, found.y);
      });
    }
  }
  settled_step(talk, device, stop);
  if (commands == InstrumentCommands::none) return;
  if (plate && !words.plate.set.empty())
    command_step(talk, device, "plate command", {device.plate_command(*plate)}, stop);
  if (mounting && !words.mounting.set.empty())
    command_step(talk, device, "mounting command", {device.mounting_command(*mounting)}, stop);
  if (place) command_step(talk, device, "position command", device.position_commands(*place), stop);
}

template <typename Device, typename Talking>
Result<InstrumentCheck> checked(const InstrumentTable& table, const std::string& address, InstrumentCommands commands,
                                const ScpiClientOptions& options, const std::stop_token& stop, Talking talking) {
  const bool black_body = table.kind == InstrumentKind::black_body;
  Device device(black_body ? "black body" : "plate stage", address, options, table);
  Talk talk(stop);
  InstrumentCheck check;
  InstrumentStep first{"connection and identity", table.speech.identity_query, StepOutcome::answered, "connected"};
  if (const auto there = device.ensure_connected(stop); !there) {
    if (there.error().code == ErrorCode::interrupted) return tl::unexpected(there.error());
    first.outcome = StepOutcome::failed;
    first.said = there.error().message;
    check.steps.push_back(std::move(first));
    return check;
  }
  check.reached = true;
  check.identity = device.client()->identity();
  if (const std::string who = to_text(check.identity); !who.empty()) first.said = who;
  talk.steps.push_back(std::move(first));
  talking(talk, device, commands, stop);
  if (talk.interrupted()) return fail(ErrorCode::interrupted, "stopped on request");
  check.steps = std::move(talk.steps);
  return check;
}

}  // namespace

bool InstrumentCheck::passed() const {
  return reached && std::none_of(steps.begin(), steps.end(),
                                 [](const InstrumentStep& step) { return step.outcome == StepOutcome::failed; });
}

Result<InstrumentCheck> check_instrument(const InstrumentTable& table, const std::string& address,
                                         InstrumentCommands commands, const ScpiClientOptions& options,
                                         const std::stop_token& stop) {
  TODBENCH_TRY_VOID(instrument_address(address, table.speech.port));
  if (table.kind == InstrumentKind::black_body)
    return checked<BlackBodyDevice>(table, address, commands, options, stop, talk_to_black_body);
  return checked<StageDevice>(table, address, commands, options, stop, talk_to_stage);
}

}  // namespace todbench
