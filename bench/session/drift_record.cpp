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

void drift_fit_fields(JsonFields& json, DriftFit& fit) {
  json.value("shape", fit.shape, std::array{DriftShape::linear, DriftShape::approach});
  json.value("change_k", fit, [](JsonFields& change, DriftFit& of) {
    change.value("value", of.change_k);
    change.value("ci95", of.change_ci95);
  });
  json.value("time_constant_s", fit.time_constant_s);
  json.value("time_constant_ci95_s", fit.time_constant_ci95);
  json.value("p_linear", fit.p_linear);
  json.value("seen_k", fit.seen_k);
  json.value("fitted_k", fit.fitted_k);
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

void drift_fields(JsonFields& json, DriftMeasure& measure) {
  json.derived("groups", measure.groups);
  json.derived("frames_each", measure.frames_each);
  json.derived("first_s", measure.first_s);
  json.derived("last_s", measure.last_s);
  json.derived("ended_by_correction", measure.ended_by_correction);
  json.value("time_s", measure.law.time_s);
  json.value("level", measure.law.level, drift_fit_fields);
  json.value("pattern", measure.law.pattern, drift_fit_fields);
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
  return {.key = "drift",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.drift) add_drift_lines(out, *measures.drift);
              },
          .fields = measure_part<&MeasureLines::drift, drift_fields>,
          .valid = [](const MeasureLines& lines) { return !lines.drift || drawable(*lines.drift); },
          .mistake = "'drift': expected lists of the same length"};
}

}  // namespace todbench
