// SPDX-License-Identifier: GPL-3.0-or-later
// Response time in measures.json.
#include <fmt/format.h>

#include <array>
#include <string>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

constexpr double ms_of_s = 1000;

Interval ms_interval(const StepTimeConstant& found) {
  return {.low = ms_of_s * found.low_s, .high = ms_of_s * found.high_s};
}

Json time_constant_json(const std::optional<StepTimeConstant>& found) {
  if (!found) return nullptr;
  return {{"value", json_number(ms_of_s * found->value_s)},
          {"ci95", json_interval(ms_interval(*found))},
          {"steps", found->steps}};
}

void add_response_lines(MeasureLines& out, const ResponseMeasure& measure) {
  const std::string settling =
      measure.settling_s > 0 ? fmt::format(", settling time of the target {:g} ms", ms_of_s * measure.settling_s) : "";
  const std::string conditions =
      fmt::format("first-order time constant; {} steps of {:g} K, {} frames of {:.4g} ms after each, {} pixels{}",
                  measure.response.both.steps, measure.delta_t_k, measure.response.samples, ms_of_s * measure.frame_s,
                  measure.bright_pixels, settling);
  const auto add = [&](const char* name, const std::optional<StepTimeConstant>& found) {
    if (found) out.lines.push_back(measure_line(name, ms_of_s * found->value_s, ms_interval(*found), conditions));
  };
  add("response_time", measure.response.both);
  add("response_time_rise", measure.response.rise);
  add("response_time_fall", measure.response.fall);
  out.response = measure;
}

Json response_json(const ResponseMeasure& measure) {
  Json points = Json::array();
  for (const StepPoint& point : measure.response.points)
    points.push_back(
        {{"time_s", json_number(point.time_s)}, {"left", json_number(point.left)}, {"rising", point.rising}});
  return {{"delta_t_k", measure.delta_t_k},
          {"frame_s", json_number(measure.frame_s)},
          {"settling_ms", json_number(ms_of_s * measure.settling_s)},
          {"dropped_steps", measure.dropped},
          {"bright_pixels", measure.bright_pixels},
          {"time_constant_ms", time_constant_json(measure.response.both)},
          {"rise_ms", time_constant_json(measure.response.rise)},
          {"fall_ms", time_constant_json(measure.response.fall)},
          {"p_first_order", json_number(measure.response.p_first_order)},
          {"points", points}};
}

ResponseMeasure response_from(const JsonReader& response) {
  ResponseMeasure found;
  found.response.both.value_s = response.at("time_constant_ms").at("value").number() / ms_of_s;
  for (const JsonReader& point : response.at("points").elements()) {
    found.response.points.push_back({.time_s = point.at("time_s").number(),
                                     .left = point.at("left").number(),
                                     .rising = point.at("rising").flag()});
  }
  return found;
}

}  // namespace

MeasureRow response_row() {
  return {
      .key = "response",
      .add =
          [](MeasureLines& out, const CameraMeasures& measures) {
            if (measures.response) add_response_lines(out, *measures.response);
            if (const auto& model = measures.response_model_ms)
              out.lines.push_back(measure_line("response_time_model", *model, {}, "time constant of the sensor model"));
          },
      .to_json =
          [](const CameraMeasures& measures) { return measures.response ? response_json(*measures.response) : Json(); },
      .read = [](MeasureLines& out, const JsonReader& part) { out.response = response_from(part); }};
}

}  // namespace todbench
