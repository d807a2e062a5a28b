// SPDX-License-Identifier: GPL-3.0-or-later
// Drift in measures.json.
#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

Interval scaled_interval(const Interval& interval, double factor) {
  Interval out;
  if (interval.low) out.low = factor * *interval.low;
  if (interval.high) out.high = factor * *interval.high;
  return out;
}

Json drift_fit_json(const DriftFit& fit) {
  return {{"shape", to_string(fit.shape)},
          {"change_k", {{"value", json_number(fit.change_k)}, {"ci95", json_interval(fit.change_ci95)}}},
          {"time_constant_s", json_number(fit.time_constant_s)},
          {"time_constant_ci95_s", json_interval(fit.time_constant_ci95)},
          {"p_linear", json_number(fit.p_linear)},
          {"seen_k", json_numbers(fit.seen_k)},
          {"fitted_k", json_numbers(fit.fitted_k)}};
}

DriftFit drift_fit_from(const JsonReader& record) {
  DriftFit fit;
  fit.shape = record.at("shape").named(std::array{DriftShape::linear, DriftShape::approach});
  fit.change_k = record.at("change_k").at("value").number();
  fit.change_ci95 = record.at("change_k").at("ci95").interval();
  fit.time_constant_s = record.at("time_constant_s").optional_number();
  fit.time_constant_ci95 = record.at("time_constant_ci95_s").interval();
  fit.p_linear = record.at("p_linear").number();
  fit.seen_k = record.at("seen_k").numbers();
  fit.fitted_k = record.at("fitted_k").numbers();
  return fit;
}

void add_drift_lines(MeasureLines& out, const DriftMeasure& measure) {
  const DriftLaw& law = measure.law;
  const double per_minute = law.per_minute(1);
  const auto add = [&](const std::string& name, const DriftFit& fit) {
    const std::string conditions = fmt::format(
        "{} of {} groups of at least {} frames, {:.1f} to {:.1f} s after a correction{}, contrast 0, kelvin on the "
        "camera's scale; {}",
        name == "drift" ? "mean" : "spatial noise (shading removed)", measure.groups, measure.frames_each,
        measure.first_s, measure.last_s, measure.ended_by_correction ? ", until the next correction" : "",
        fit.shape == DriftShape::linear ? "linear" : "exponential approach");
    out.lines.push_back(measure_line(name + "_rate", per_minute * fit.change_k,
                                     scaled_interval(fit.change_ci95, per_minute), conditions));
    if (fit.time_constant_s) {
      out.lines.push_back(
          measure_line(name + "_time_constant", fit.time_constant_s, fit.time_constant_ci95, conditions));
    }
  };
  add("drift", law.level), add("drift_pattern", law.pattern);
  out.drift = measure;
}

Json drift_json(const DriftMeasure& measure) {
  return {{"groups", measure.groups},
          {"frames_each", measure.frames_each},
          {"first_s", json_number(measure.first_s)},
          {"last_s", json_number(measure.last_s)},
          {"ended_by_correction", measure.ended_by_correction},
          {"time_s", json_numbers(measure.law.time_s)},
          {"level", drift_fit_json(measure.law.level)},
          {"pattern", drift_fit_json(measure.law.pattern)}};
}

DriftMeasure drift_from(const JsonReader& drift) {
  DriftMeasure found;
  found.law = {drift.at("time_s").numbers(), drift_fit_from(drift.at("level")), drift_fit_from(drift.at("pattern"))};
  return found;
}

bool drawable(const DriftMeasure& drift) {
  const DriftLaw& law = drift.law;
  const auto whole = [&](const DriftFit& fit) {
    return fit.seen_k.size() == law.time_s.size() && fit.fitted_k.size() == law.time_s.size();
  };
  return law.time_s.size() > 1 && law.time_s.back() > law.time_s.front() && whole(law.level) && whole(law.pattern);
}

}  // namespace

MeasureRow drift_row() {
  return {
      .key = "drift",
      .add =
          [](MeasureLines& out, const CameraMeasures& measures) {
            if (measures.drift) add_drift_lines(out, *measures.drift);
          },
      .to_json = [](const CameraMeasures& measures) { return measures.drift ? drift_json(*measures.drift) : Json(); },
      .read = [](MeasureLines& out, const JsonReader& part) { out.drift = drift_from(part); },
      .valid = [](const MeasureLines& lines) { return !lines.drift || drawable(*lines.drift); },
      .mistake = "'drift': expected lists of the same length"};
}

}  // namespace todbench
