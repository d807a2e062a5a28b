// SPDX-License-Identifier: GPL-3.0-or-later
// Automatic gain in measures.json.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

constexpr double gain_ms_of_s = 1000;

std::string level_words(const GainControlMeasure& measure, const GainLevel& level) {
  return fmt::format("{:.4g} {}/K at {:g} K, picture from {:.5g} to {:.5g} {}", level.gain().value, measure.unit,
                     level.set_delta_t_k, level.lowest, level.highest, measure.unit);
}

/// Ratio with the intervals of both gains, by the root of the sum of squares.
Estimate gain_ratio(const GainControlMeasure& measure) {
  const Estimate large = measure.largest().gain(), small = measure.smallest().gain();
  const double value = large.value / small.value;
  const double half = std::abs(value) * std::hypot((large.high - large.low) / (2 * large.value),
                                                   (small.high - small.low) / (2 * small.value));
  return {value, value - half, value + half};
}

void add_gain_lines(MeasureLines& out, const GainControlMeasure& measure) {
  if (measure.settling) {
    const ResponseMeasure& settling = *measure.settling;
    const StepTimeConstant& found = settling.response.both;
    out.lines.push_back(measure_line(
        "gain_settling_time", gain_ms_of_s * found.value_s, {gain_ms_of_s * found.low_s, gain_ms_of_s * found.high_s},
        fmt::format("{} steps of {:g} K move the level round the target by {:.4g} {}; {} frames of {:.4g} ms, "
                    "settling time of the target {:g} ms",
                    found.steps, settling.delta_t_k, settling.change, measure.unit, settling.response.samples,
                    gain_ms_of_s * settling.frame_s, gain_ms_of_s * settling.settling_s)));
  }
  const Estimate ratio = gain_ratio(measure);
  out.lines.push_back(measure_line("gain_ratio", ratio.value, ratio.interval(),
                                   level_words(measure, measure.largest()) + "; " +
                                       level_words(measure, measure.smallest()) +
                                       fmt::format("; mean of {} frames each", measure.frames)));
  out.gain_control = measure;
}

Json gain_json(const GainControlMeasure& measure) {
  Json levels = Json::array(), settling;
  for (const GainLevel& level : measure.levels) {
    levels.push_back({{"set_delta_t_k", level.set_delta_t_k},
                      {"said_delta_t_k", json_number(level.said_delta_t_k)},
                      {"surround", json_number(level.surround)},
                      {"lowest", json_number(level.lowest)},
                      {"highest", json_number(level.highest)},
                      {"contrast", json_number(level.contrast)},
                      {"contrast_u", json_number(level.contrast_u)}});
  }
  if (measure.settling) {
    Json points = Json::array();
    for (const StepPoint& point : measure.settling->response.points)
      points.push_back(
          {{"time_s", json_number(point.time_s)}, {"left", json_number(point.left)}, {"rising", point.rising}});
    settling = {{"delta_t_k", measure.settling->delta_t_k},
                {"change", json_number(measure.settling->change)},
                {"time_constant_ms", json_number(gain_ms_of_s * measure.settling->response.both.value_s)},
                {"p_first_order", json_number(measure.settling->response.p_first_order)},
                {"points", points}};
  }
  return {{"unit", measure.unit}, {"frames", measure.frames}, {"levels", levels}, {"settling", settling}};
}

GainControlMeasure gain_from(const JsonReader& part) {
  GainControlMeasure out;
  out.unit = part.at("unit").text();
  for (const JsonReader& level : part.at("levels").elements()) {
    out.levels.push_back({.set_delta_t_k = level.at("set_delta_t_k").number(),
                          .said_delta_t_k = level.at("said_delta_t_k").number(),
                          .surround = level.at("surround").number(),
                          .lowest = level.at("lowest").number(),
                          .highest = level.at("highest").number(),
                          .contrast = level.at("contrast").number(),
                          .contrast_u = level.at("contrast_u").number()});
  }
  const JsonReader settling = part.at("settling");
  if (settling.is_null()) return out;
  out.settling.emplace();
  out.settling->delta_t_k = settling.at("delta_t_k").number();
  out.settling->response.both.value_s = settling.at("time_constant_ms").number() / gain_ms_of_s;
  for (const JsonReader& point : settling.at("points").elements()) {
    out.settling->response.points.push_back({.time_s = point.at("time_s").number(),
                                             .left = point.at("left").number(),
                                             .rising = point.at("rising").flag()});
  }
  return out;
}

}  // namespace

MeasureRow gain_control_row() {
  return {.key = "gain_control",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.gain_control) add_gain_lines(out, *measures.gain_control);
              },
          .to_json =
              [](const CameraMeasures& measures) {
                return measures.gain_control ? gain_json(*measures.gain_control) : Json();
              },
          .read = [](MeasureLines& out, const JsonReader& part) { out.gain_control = gain_from(part); },
          .valid = [](const MeasureLines& lines) { return !lines.gain_control || !lines.gain_control->levels.empty(); },
          .mistake = "'gain_control.levels': expected at least one level"};
}

}  // namespace todbench
