// SPDX-License-Identifier: GPL-3.0-or-later
// Automatic gain in measures.json.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

constexpr double gain_ms_of_s = 1000;

std::string level_words(const GainControlMeasure& measure, const GainLevel& level) {
  return fmt::format("{:.4g} {}/K at {:g} K, picture from {:.5g} to {:.5g} {}", level.gain().value, measure.unit,
                     level.set_delta_t_k, level.lowest, level.highest, measure.unit);
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
  const Estimate ratio = measure.ratio();
  out.lines.push_back(measure_line("gain_ratio", ratio.value, ratio.interval(),
                                   level_words(measure, measure.largest()) + "; " +
                                       level_words(measure, measure.smallest()) +
                                       fmt::format("; mean of {} frames each", measure.frames)));
  out.gain_control = measure;
}

void gain_level_fields(JsonFields& json, GainLevel& level) {
  json.value("set_delta_t_k", level.set_delta_t_k);
  json.value("said_delta_t_k", level.said_delta_t_k);
  json.value("surround", level.surround);
  json.value("lowest", level.lowest);
  json.value("highest", level.highest);
  json.value("contrast", level.contrast);
  json.value("contrast_u", level.contrast_u);
  json.later("triangles", level.triangles);
}

void gain_settling_fields(JsonFields& json, ResponseMeasure& settling) {
  StepResponse& found = settling.response;
  double time_constant_ms = gain_ms_of_s * found.both.value_s;
  json.value("delta_t_k", settling.delta_t_k);
  json.derived("change", settling.change);
  json.value("time_constant_ms", time_constant_ms);
  json.derived("p_first_order", found.p_first_order);
  json.value("points", found.points, step_point_fields);
  if (json.reading()) found.both.value_s = time_constant_ms / gain_ms_of_s;
}

void gain_fields(JsonFields& json, GainControlMeasure& measure) {
  json.value("unit", measure.unit);
  json.derived("frames", measure.frames);
  json.value("levels", measure.levels, gain_level_fields);
  json.value("settling", measure.settling, gain_settling_fields);
}

}  // namespace

MeasureRow gain_control_row() {
  return {.key = "gain_control",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.gain_control) add_gain_lines(out, *measures.gain_control);
              },
          .fields = measure_part<&MeasureLines::gain_control, gain_fields>,
          .valid = [](const MeasureLines& lines) { return !lines.gain_control || !lines.gain_control->levels.empty(); },
          .mistake = "'gain_control.levels': expected at least one level"};
}

}  // namespace todbench
