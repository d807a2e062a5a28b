// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/drift_record.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace todbench {
namespace {

Interval interval_of(const DriftInterval& interval, double factor = 1) {
  Interval out;
  if (interval.low) out.low = factor * *interval.low;
  if (interval.high) out.high = factor * *interval.high;
  return out;
}

Json drift_numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

Json drift_fit_json(const DriftFit& fit) {
  return {{"shape", to_string(fit.shape)},
          {"change_k", {{"value", json_number(fit.change_k)}, {"ci95", json_interval(interval_of(fit.change_ci95))}}},
          {"time_constant_s", json_number(fit.time_constant_s)},
          {"time_constant_ci95_s", json_interval(interval_of(fit.time_constant_ci95))},
          {"p_linear", json_number(fit.p_linear)},
          {"seen_k", drift_numbers(fit.seen_k)},
          {"fitted_k", drift_numbers(fit.fitted_k)}};
}

std::vector<double> drift_numbers_from(const JsonReader& list) {
  std::vector<double> values;
  for (const JsonReader& value : list.elements()) values.push_back(value.number());
  return values;
}

DriftFit drift_fit_from(const JsonReader& record) {
  DriftFit fit;
  fit.shape = record.at("shape").named(std::array{DriftShape::linear, DriftShape::approach});
  fit.change_k = record.at("change_k").at("value").number();
  const Interval change = record.at("change_k").at("ci95").interval();
  fit.change_ci95 = {.low = change.low, .high = change.high};
  fit.time_constant_s = record.at("time_constant_s").optional_number();
  const Interval constant = record.at("time_constant_ci95_s").interval();
  fit.time_constant_ci95 = {.low = constant.low, .high = constant.high};
  fit.p_linear = record.at("p_linear").number();
  fit.seen_k = drift_numbers_from(record.at("seen_k"));
  fit.fitted_k = drift_numbers_from(record.at("fitted_k"));
  return fit;
}

}  // namespace

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
    out.lines.push_back(
        {name + "_rate", "K/min", per_minute * fit.change_k, interval_of(fit.change_ci95, per_minute), conditions});
    if (fit.time_constant_s) {
      out.lines.push_back(
          {name + "_time_constant", "s", fit.time_constant_s, interval_of(fit.time_constant_ci95), conditions});
    }
  };
  add("drift", law.level), add("drift_pattern", law.pattern);
  out.drift = law;
}

Json drift_json(const DriftMeasure& measure) {
  return {{"groups", measure.groups},
          {"frames_each", measure.frames_each},
          {"first_s", json_number(measure.first_s)},
          {"last_s", json_number(measure.last_s)},
          {"ended_by_correction", measure.ended_by_correction},
          {"time_s", drift_numbers(measure.law.time_s)},
          {"level", drift_fit_json(measure.law.level)},
          {"pattern", drift_fit_json(measure.law.pattern)}};
}

DriftLaw drift_from(const JsonReader& drift) {
  return {drift_numbers_from(drift.at("time_s")), drift_fit_from(drift.at("level")),
          drift_fit_from(drift.at("pattern"))};
}

bool drift_drawable(const std::optional<MeasureLines>& side) {
  if (!side || !side->drift) return true;
  const DriftLaw& law = *side->drift;
  const auto whole = [&](const DriftFit& fit) {
    return fit.seen_k.size() == law.time_s.size() && fit.fitted_k.size() == law.time_s.size();
  };
  return law.time_s.size() > 1 && law.time_s.back() > law.time_s.front() && whole(law.level) && whole(law.pattern);
}

}  // namespace todbench
