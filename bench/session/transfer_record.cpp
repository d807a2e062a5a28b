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

void transfer_step_fields(JsonFields& json, TransferStep& step) {
  json.value("set_delta_t_k", step.set_delta_t_k);
  json.value("said_delta_t_k", step.said_delta_t_k);
  json.value("seen_delta_t_k", step.seen_delta_t_k);
  json.value("seen_u_k", step.seen_u_k);
}

void transfer_fields(JsonFields& json, TransferMeasure& transfer) {
  SignalTransfer& line = transfer.line;
  json.derived("frames_each", transfer.frames_each);
  json.value("steps", transfer.steps, transfer_step_fields);
  json.value("slope", line.slope);
  json.derived("slope_u", line.slope_u);
  json.value("offset_k", line.offset);
  json.derived("chi2", line.chi2);
  json.derived("degrees_of_freedom", line.degrees_of_freedom);
  json.derived("p", line.p);
  json.derived("nonlinearity_percent", line.nonlinearity_percent);
}

}  // namespace

MeasureRow transfer_row() {
  return {.key = "transfer",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.transfer) add_transfer(out, *measures.transfer);
              },
          .fields = measure_part<&MeasureLines::transfer, transfer_fields>};
}

}  // namespace todbench
