// SPDX-License-Identifier: GPL-3.0-or-later
// Signal transfer in measures.json.
#include <fmt/format.h>

#include <string>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

void add_transfer(MeasureLines& out, const TransferMeasure& transfer) {
  const SignalTransfer& line = transfer.line;
  const double half = transfer.slope_half_width();
  const std::string conditions =
      fmt::format("{} steps of {} frames, observed contrast over that of the target behind air and collimator",
                  transfer.steps.size(), transfer.frames_each);
  out.lines.push_back(measure_line("transfer_slope", line.slope, {line.slope - half, line.slope + half}, conditions));
  out.lines.push_back(measure_line("transfer_offset", line.offset, {}, conditions));
  out.lines.push_back(measure_line("transfer_nonlinearity", line.nonlinearity_percent, {}, conditions));
  out.transfer = transfer;
}

Json transfer_json(const TransferMeasure& transfer) {
  Json steps = Json::array();
  for (const TransferStep& step : transfer.steps) {
    steps.push_back({{"set_delta_t_k", step.set_delta_t_k},
                     {"said_delta_t_k", json_number(step.said_delta_t_k)},
                     {"seen_delta_t_k", json_number(step.seen_delta_t_k)},
                     {"seen_u_k", json_number(step.seen_u_k)}});
  }
  return {{"frames_each", transfer.frames_each},
          {"steps", steps},
          {"slope", json_number(transfer.line.slope)},
          {"slope_u", json_number(transfer.line.slope_u)},
          {"offset_k", json_number(transfer.line.offset)},
          {"chi2", json_number(transfer.line.chi2)},
          {"degrees_of_freedom", transfer.line.degrees_of_freedom},
          {"p", json_number(transfer.line.p)},
          {"nonlinearity_percent", json_number(transfer.line.nonlinearity_percent)}};
}

TransferMeasure transfer_from(const JsonReader& transfer) {
  TransferMeasure found;
  found.line.slope = transfer.at("slope").number();
  found.line.offset = transfer.at("offset_k").number();
  for (const JsonReader& step : transfer.at("steps").elements()) {
    found.steps.push_back({step.at("set_delta_t_k").number(), step.at("said_delta_t_k").number(),
                           step.at("seen_delta_t_k").number(), step.at("seen_u_k").number()});
  }
  return found;
}

}  // namespace

MeasureRow transfer_row() {
  return {
      .key = "transfer",
      .add =
          [](MeasureLines& out, const CameraMeasures& measures) {
            if (measures.transfer) add_transfer(out, *measures.transfer);
          },
      .to_json =
          [](const CameraMeasures& measures) { return measures.transfer ? transfer_json(*measures.transfer) : Json(); },
      .read = [](MeasureLines& out, const JsonReader& part) { out.transfer = transfer_from(part); }};
}

}  // namespace todbench
