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

void time_constant_fields(JsonFields& json, StepTimeConstant& found) {
  double value_ms = ms_of_s * found.value_s;
  json.value("value", value_ms);
  json.derived("ci95", ms_interval(found));
  json.derived("steps", found.steps);
  if (json.reading()) found.value_s = value_ms / ms_of_s;
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

void response_fields(JsonFields& json, ResponseMeasure& measure) {
  StepResponse& found = measure.response;
  json.derived("delta_t_k", measure.delta_t_k);
  json.derived("frame_s", measure.frame_s);
  json.derived("settling_ms", ms_of_s * measure.settling_s);
  json.derived("dropped_steps", measure.dropped);
  json.derived("bright_pixels", measure.bright_pixels);
  json.value("time_constant_ms", found.both, time_constant_fields);
  json.derived("rise_ms", found.rise, time_constant_fields);
  json.derived("fall_ms", found.fall, time_constant_fields);
  json.derived("p_first_order", found.p_first_order);
  json.value("points", found.points, step_point_fields);
}

}  // namespace

void step_point_fields(JsonFields& json, StepPoint& point) {
  json.value("time_s", point.time_s);
  json.value("left", point.left);
  json.value("rising", point.rising);
}

MeasureRow response_row() {
  return {
      .key = "response",
      .add =
          [](MeasureLines& out, const CameraMeasures& measures) {
            if (measures.response) add_response_lines(out, *measures.response);
            if (const auto& model = measures.response_model_ms)
              out.lines.push_back(measure_line("response_time_model", *model, {}, "time constant of the sensor model"));
          },
      .fields = measure_part<&MeasureLines::response, response_fields>};
}

}  // namespace todbench
