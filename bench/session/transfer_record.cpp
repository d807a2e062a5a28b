// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/transfer_record.h"

namespace todbench {

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

TransferCurve transfer_from(const JsonReader& transfer) {
  TransferCurve curve{{}, transfer.at("slope").number(), transfer.at("offset_k").number()};
  for (const JsonReader& step : transfer.at("steps").elements()) {
    curve.steps.push_back({step.at("set_delta_t_k").number(), step.at("said_delta_t_k").number(),
                           step.at("seen_delta_t_k").number(), step.at("seen_u_k").number()});
  }
  return curve;
}

}  // namespace todbench
